// The 256-bit binary descriptor of a point and its distance.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace msf {

using Descriptor = std::array<uint64_t, 4>;

// Hamming distance, 0..256.
inline int DescriptorDistance(const Descriptor& a, const Descriptor& b) {
  return std::popcount(a[0] ^ b[0]) + std::popcount(a[1] ^ b[1]) + std::popcount(a[2] ^ b[2]) +
         std::popcount(a[3] ^ b[3]);
}

inline constexpr int kStrictDescriptorDistance = 50;
inline constexpr int kLooseDescriptorDistance = 100;

}  // namespace msf
