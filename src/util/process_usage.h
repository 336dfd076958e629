// What this process has used so far.
#pragma once

#include <cstdint>

namespace msf {

struct ProcessUsage {
  double cpu_time_s = 0;          // of all threads, user and system
  int64_t peak_memory_bytes = 0;  // largest resident size (VmHWM); 0 when the system does not tell
};

ProcessUsage ReadProcessUsage();

}  // namespace msf
