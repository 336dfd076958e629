#include "bench/machine.h"

#include <fmt/format.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <fstream>

#include "bench/build_info.h"

namespace msf {
namespace {

// The value of the first "key : value" or KEY="value" line.
std::string ReadValue(const char* file, const std::string& key, char separator) {
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    const size_t at = line.find(separator);
    if (!line.starts_with(key) || at == std::string::npos) continue;
    const size_t first = line.find_first_not_of(" \t\"", at + 1);
    const size_t last = line.find_last_not_of(" \t\"");
    return first == std::string::npos ? "" : line.substr(first, last - first + 1);
  }
  return "unknown";
}

}  // namespace

BuildInfo ReadBuildInfo() {
  return {MSF_BUILD_VERSION, MSF_BUILD_COMMIT, MSF_BUILD_COMPILER, MSF_BUILD_FLAGS};
}

std::string BuildInfo::ToString() const {
  return fmt::format("msf-slam {}, commit {}, {}, {}", version, commit, compiler, flags);
}

Machine ReadMachine() {
  Machine machine;
  machine.processor = ReadValue("/proc/cpuinfo", "model name", ':');
  machine.num_processors = static_cast<int>(sysconf(_SC_NPROCESSORS_ONLN));
  machine.memory_gb = static_cast<double>(sysconf(_SC_PHYS_PAGES)) *
                      static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 30);
  machine.system = ReadValue("/etc/os-release", "PRETTY_NAME", '=');
  utsname name{};
  if (uname(&name) == 0) machine.system += fmt::format(", Linux {}", name.release);
  return machine;
}

std::string Machine::ToString() const {
  return fmt::format("{} ({} processors), {:.1f} GiB, {}", processor, num_processors, memory_gb,
                     system);
}

}  // namespace msf
