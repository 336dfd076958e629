// The 256 comparisons of a descriptor.
#pragma once

#include <array>
#include <cstdint>

namespace msf {

// Bit = brightness at (x0, y0) < brightness at (x1, y1); px from the point, in the frame of its
// orientation.
struct BriefTest {
  int8_t x0, y0, x1, y1;
};

// All places lie within this radius, so that a rotated pattern stays inside the orientation's disc.
inline constexpr int kPatchRadiusPx = 15;

extern const std::array<BriefTest, 256> kBriefPattern;

}  // namespace msf
