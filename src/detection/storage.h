// How the numbers of a value lie in memory while a network runs.
#pragma once

#include <cstddef>
#include <cstdint>

#include "detection/tensor.h"

namespace msf {

enum class NumberFormat { kFloat32, kBfloat16, kUint8 };

// One value's memory. Images [1, C, H, W] that fast operators work on lie channels last (the
// channels of a pixel side by side, then the pixels of a row); everything else is dense row-major.
struct Storage {
  NumberFormat format = NumberFormat::kFloat32;
  bool channels_last = false;
  // kUint8 only: number = (stored - zero_point) * scale.
  float scale = 1;
  int zero_point = 0;

  friend bool operator==(const Storage&, const Storage&) = default;
};

size_t BytesPerElement(NumberFormat format);
size_t NumBytes(const Shape& shape, const Storage& storage);

// Rounds to the nearest bfloat16, ties to even.
uint16_t FloatToBfloat16(float x);

// Copies a value from one storage to another: number format, scale and order of the elements may
// differ. uint8 saturates.
void Convert(const Shape& shape, const void* from, const Storage& from_storage, void* to,
             const Storage& to_storage);

// A run of channels in an image that lies channels last. Sizes in bytes.
struct ChannelRun {
  size_t pixel_bytes;  // of all channels of one pixel
  size_t first_byte;   // where the run starts within a pixel
};

// Copies `run_bytes` of each of `pixels` pixels.
void CopyChannels(const uint8_t* from, const ChannelRun& source, uint8_t* to,
                  const ChannelRun& target, size_t run_bytes, size_t pixels);

// Enlarges an image of height x width by whole factors, repeating pixels of `pixel_bytes`.
void RepeatPixels(const uint8_t* from, size_t height, size_t width, size_t pixel_bytes,
                  size_t factor_y, size_t factor_x, uint8_t* to);

}  // namespace msf
