#include "apps/arguments.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <system_error>

#include "apps/command.h"

namespace msf {
namespace {

namespace fs = std::filesystem;

// The whole of `text` as a number, or nothing.
template <typename Number>
std::optional<Number> Parse(const std::string& text) {
  Number number{};
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  return error == std::errc() && rest == end ? std::optional(number) : std::nullopt;
}

// Throws unless files can be made in the folder, for the sake of `wanted`.
void RequireWritableInside(const fs::path& folder, const fs::path& wanted) {
  std::error_code ignored;
  std::string problem;
  if (!fs::exists(folder, ignored)) {
    problem = "there is no folder " + folder.string();
  } else if (!fs::is_directory(folder, ignored)) {
    problem = folder.string() + " is no folder";
  } else if (access(folder.c_str(), W_OK | X_OK) != 0) {
    problem = fmt::format("the folder {}: {}", folder.string(), std::strerror(errno));
  }
  if (!problem.empty())
    throw CommandFailure(fmt::format("{}: cannot be written: {}", wanted.string(), problem));
}

}  // namespace

CLI::Validator NumberFrom(double least, double most) {
  return {[least, most](std::string& text) {
            const std::optional<double> number = Parse<double>(text);
            if (number && *number >= least && *number <= most) return std::string();
            return fmt::format("'{}' is no number from {} to {}", text, least, most);
          },
          fmt::format("{} to {}", least, most)};
}

CLI::Validator Seed() {
  return {[](std::string& text) {
            const std::optional<uint64_t> seed = Parse<uint64_t>(text);
            if (seed && std::to_string(*seed) == text) return std::string();
            return fmt::format("'{}' is no whole number from 0 to 2^64 - 1", text);
          },
          ""};
}

CLI::Validator NetworkSide() {
  return {[](std::string& text) {
            const std::optional<int> side = Parse<int>(text);
            if (side && *side >= 32 && *side <= 4096 && *side % 32 == 0) return std::string();
            return fmt::format("'{}' must be a multiple of 32, from 32 to 4096", text);
          },
          ""};
}

void RequireWritableFile(const fs::path& file) {
  if (file.empty()) return;
  std::error_code ignored;
  if (fs::is_character_file(file, ignored) || fs::is_fifo(file, ignored)) return;
  if (fs::is_directory(file, ignored))
    throw CommandFailure(file.string() + ": cannot be written: it is a folder; name a file");
  RequireWritableInside(file.has_parent_path() ? file.parent_path() : ".", file);
}

void RequireWritableFolder(const fs::path& folder) {
  if (folder.empty()) return;
  // The folders that are missing will be made in the first one that is not.
  std::error_code ignored;
  fs::path present = fs::absolute(folder);
  while (!fs::exists(present, ignored) && present.has_relative_path())
    present = present.parent_path();
  RequireWritableInside(present, folder);
}

void MakeFolder(const fs::path& folder) {
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (failure) throw CommandFailure(folder.string() + ": cannot be made: " + failure.message());
}

}  // namespace msf
