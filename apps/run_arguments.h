// What `msf-slam run` was asked to do.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "system/system_options.h"

namespace msf {

struct RunArguments {
  std::filesystem::path dataset;
  std::string camera;
  std::filesystem::path config_file;
  std::vector<std::string> assignments;
  std::string dynamic;
  std::string detector;
  bool deterministic = false;
  bool real_time = false;
  int buffers = 1;        // in which the camera keeps frames while tracking is busy
  size_t max_frames = 0;  // 0: all
  std::filesystem::path out_folder;
  std::optional<uint64_t> seed;
  std::filesystem::path overlay;
  bool labels = false;
};

void DeclareRunArguments(CLI::App& command, RunArguments& arguments);

// The options after file, --set and the switches, checked; throws CommandFailure with a sentence.
SystemOptions ResolveOptions(const RunArguments& arguments);

}  // namespace msf
