// What commands ask of their arguments, before they begin to work.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>

namespace msf {

// A finite number. (CLI::Range lets NaN through.)
CLI::Validator NumberFrom(double least, double most);

// A whole number of 64 bits. (CLI11 takes -1 for 18446744073709551615, and 010 for 8.)
CLI::Validator Seed();

// A side of a network's input in pixels. (The layers halve it five times.)
CLI::Validator NetworkSide();

// Throws CommandFailure unless a file can be written there once the work is done; the folder must
// exist. Nothing is asked of an empty path.
void RequireWritableFile(const std::filesystem::path& file);

// The same for a folder of files, which need not exist yet.
void RequireWritableFolder(const std::filesystem::path& folder);

// Makes the folder, and those above it; throws CommandFailure.
void MakeFolder(const std::filesystem::path& folder);

}  // namespace msf
