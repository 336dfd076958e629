// What a benchmark ran on and what it was built from.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace msf {

// Of this program; the same for every run of one build.
struct BuildInfo {
  std::string version;
  std::string commit;  // "unknown" outside a git checkout; "+" behind it: with changes
  std::string compiler;
  std::string flags;  // CPU level, kind of build
  std::string ToString() const;
};
BuildInfo ReadBuildInfo();

struct Machine {
  std::string processor;
  int num_processors = 0;
  double memory_gb = 0;
  std::string system;  // distribution and kernel
  std::string ToString() const;
};
Machine ReadMachine();

}  // namespace msf
