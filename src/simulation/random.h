// The simulator's random numbers: the same seed gives the same numbers on every machine and
// library.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace msf {

// SplitMix64 (Steele et al. 2014). Small enough to be created for every thing that needs numbers of
// its own.
class Random {
 public:
  explicit Random(uint64_t seed) : state_(seed) {}

  uint64_t Next() {
    uint64_t z = (state_ += 0x9E3779B97F4A7C15ull);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return z ^ (z >> 31);
  }

  // In [0, 1), and in [low, high).
  double Uniform() { return static_cast<double>(Next() >> 11) * 0x1p-53; }
  double Uniform(double low, double high) { return low + (high - low) * Uniform(); }
  // In [low, high], both included, low <= high.
  int Int(int low, int high) {
    const uint64_t count = static_cast<uint64_t>(high) - static_cast<uint64_t>(low) + 1;
    return low + static_cast<int>(count > 0 ? Next() % count : 0);
  }
  bool Chance(double probability) { return Uniform() < probability; }
  // Standard normal (Box-Muller).
  double Normal() {
    const double radius = std::sqrt(-2 * std::log(1 - Uniform()));
    return radius * std::cos(2 * std::numbers::pi * Uniform());
  }

  // An independent stream for a part of the work, whatever was drawn here before or after.
  Random Fork(uint64_t key) const {
    Random mixed(state_ ^ (key * 0xD1342543DE82EF95ull + 0x2545F4914F6CDD1Dull));
    return Random(mixed.Next());
  }

 private:
  uint64_t state_;
};

}  // namespace msf
