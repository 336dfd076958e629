#include "bench/energy_counter.h"

#include <fstream>

namespace msf {
namespace {

std::optional<uint64_t> ReadNumber(const std::filesystem::path& file) {
  std::ifstream stream(file);
  uint64_t number = 0;
  if (!(stream >> number)) return std::nullopt;
  return number;
}

// "intel-rapl:0" is a package, "intel-rapl:0:1" a part of it that is counted there already.
bool IsPackage(const std::string& name) {
  const size_t colon = name.find(':');
  return name.starts_with("intel-rapl:") && name.find(':', colon + 1) == std::string::npos;
}

}  // namespace

EnergyCounter::EnergyCounter(const std::filesystem::path& folder) {
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none)) {
    if (!IsPackage(entry.path().filename().string())) continue;
    const std::optional<uint64_t> start = ReadNumber(entry.path() / "energy_uj");
    if (!start) continue;
    const std::optional<uint64_t> range = ReadNumber(entry.path() / "max_energy_range_uj");
    zones_.push_back({entry.path() / "energy_uj", *start, range.value_or(0)});
  }
}

std::optional<double> EnergyCounter::Joules() const {
  if (zones_.empty()) return std::nullopt;
  double joules = 0;
  for (const Zone& zone : zones_) {
    const std::optional<uint64_t> now = ReadNumber(zone.file);
    if (!now) return std::nullopt;
    const uint64_t used =
        *now >= zone.start_uj ? *now - zone.start_uj : *now + zone.range_uj - zone.start_uj;
    joules += 1e-6 * static_cast<double>(used);
  }
  return joules;
}

}  // namespace msf
