// The row filters of PNG (ISO/IEC 15948, clause 9), undone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>

namespace msf {

// Undoes the filters of an image of `height` rows of `width` pixels of kPixelBytes bytes each.
// `filtered` holds the rows, each led by its filter byte, and may be read up to kUnfilterPadding
// bytes past its end. Row y goes to `out + y * out_stride` with the bytes of every pixel in reverse
// order: RGB becomes BGR, and big-endian 16-bit numbers become little-endian. False when a filter
// byte is not one of the five. Instantiated for 1, 2 and 3 bytes.
template <int kPixelBytes>
bool UnfilterPng(const uint8_t* filtered, int width, int height, uint8_t* out, size_t out_stride);

inline constexpr size_t kUnfilterPadding = 8;

// Paeth's prediction from the left, upper and upper left bytes: whichever is nearest to left + up -
// up_left.
inline uint8_t PredictPaeth(int left, int up, int up_left) {
  const int to_left = std::abs(up - up_left);
  const int to_up = std::abs(left - up_left);
  const int to_up_left = std::abs(left + up - 2 * up_left);
  if (to_left <= to_up && to_left <= to_up_left) return static_cast<uint8_t>(left);
  return static_cast<uint8_t>(to_up <= to_up_left ? up : up_left);
}

}  // namespace msf
