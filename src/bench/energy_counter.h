// The energy that the processor has used, where the kernel tells it (RAPL).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace msf {

// Counts from its making on. Sums the packages of the machine, whatever runs on them.
class EnergyCounter {
 public:
  explicit EnergyCounter(const std::filesystem::path& folder = "/sys/class/powercap");

  // Joules since the making; nothing when the kernel has no counter that may be read. A counter
  // that went over its end once is accounted for.
  std::optional<double> Joules() const;

 private:
  struct Zone {
    std::filesystem::path file;
    uint64_t start_uj = 0;
    uint64_t range_uj = 0;
  };
  std::vector<Zone> zones_;
};

}  // namespace msf
