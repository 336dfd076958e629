#include "util/process_usage.h"

#include <time.h>

#include <fstream>
#include <sstream>
#include <string>

namespace msf {

ProcessUsage ReadProcessUsage() {
  ProcessUsage usage;
  timespec cpu_time{};
  if (clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &cpu_time) == 0) {
    usage.cpu_time_s =
        static_cast<double>(cpu_time.tv_sec) + 1e-9 * static_cast<double>(cpu_time.tv_nsec);
  }
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    std::istringstream words(line);
    std::string key;
    int64_t kibibytes = 0;
    if (words >> key >> kibibytes && key == "VmHWM:") usage.peak_memory_bytes = kibibytes * 1024;
  }
  return usage;
}

}  // namespace msf
