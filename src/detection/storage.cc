#include "detection/storage.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "util/check.h"

namespace msf {
namespace {

// Here rather than in FloatToBfloat16() so that loops over it become vector code.
inline uint16_t RoundToBfloat16(float x) {
  const uint32_t bits = std::bit_cast<uint32_t>(x);
  return static_cast<uint16_t>((bits + 0x7fffu + ((bits >> 16) & 1u)) >> 16);
}

struct FloatCodec {
  using Stored = float;
  float Load(float x) const { return x; }
  float Store(float x) const { return x; }
};

struct Bfloat16Codec {
  using Stored = uint16_t;
  float Load(uint16_t x) const { return std::bit_cast<float>(static_cast<uint32_t>(x) << 16); }
  uint16_t Store(float x) const { return RoundToBfloat16(x); }
};

struct Uint8Codec {
  using Stored = uint8_t;
  explicit Uint8Codec(const Storage& storage)
      : scale(storage.scale),
        inverse(1.0f / storage.scale),
        zero_point(static_cast<float>(storage.zero_point)) {}
  float Load(uint8_t x) const { return (static_cast<float>(x) - zero_point) * scale; }
  uint8_t Store(float x) const {
    const float rounded = std::nearbyint(x * inverse + zero_point);
    return static_cast<uint8_t>(rounded > 0 ? std::min(rounded, 255.0f) : 0.0f);  // NaN becomes 0
  }
  float scale, inverse, zero_point;
};

// Position of pixel 0 and the steps between channels and pixels, in elements.
struct Order {
  size_t channel_step;
  size_t pixel_step;
};

template <typename From, typename To>
void ConvertElements(const Shape& shape, const void* from, const From& from_codec, bool from_last,
                     void* to, const To& to_codec, bool to_last) {
  const auto* x = static_cast<const typename From::Stored*>(from);
  auto* y = static_cast<typename To::Stored*>(to);
  const size_t count = static_cast<size_t>(NumElements(shape));
  if (from_last == to_last) {
    for (size_t i = 0; i < count; ++i) y[i] = to_codec.Store(from_codec.Load(x[i]));
    return;
  }
  MSF_CHECK(shape.size() == 4 && shape[0] == 1, "only single images lie channels last");
  const size_t channels = static_cast<size_t>(shape[1]);
  const size_t pixels = static_cast<size_t>(shape[2] * shape[3]);
  const Order last{1, channels}, first{pixels, 1};
  const Order source = from_last ? last : first, target = to_last ? last : first;
  for (size_t p = 0; p < pixels; ++p) {
    for (size_t c = 0; c < channels; ++c) {
      const float value = from_codec.Load(x[c * source.channel_step + p * source.pixel_step]);
      y[c * target.channel_step + p * target.pixel_step] = to_codec.Store(value);
    }
  }
}

// Calls use(codec) with the codec of a storage.
template <typename Use>
void WithCodec(const Storage& storage, const Use& use) {
  switch (storage.format) {
    case NumberFormat::kFloat32:
      use(FloatCodec());
      return;
    case NumberFormat::kBfloat16:
      use(Bfloat16Codec());
      return;
    case NumberFormat::kUint8:
      use(Uint8Codec(storage));
      return;
  }
}

}  // namespace

size_t BytesPerElement(NumberFormat format) {
  switch (format) {
    case NumberFormat::kFloat32:
      return 4;
    case NumberFormat::kBfloat16:
      return 2;
    case NumberFormat::kUint8:
      return 1;
  }
  return 0;
}

size_t NumBytes(const Shape& shape, const Storage& storage) {
  return static_cast<size_t>(NumElements(shape)) * BytesPerElement(storage.format);
}

uint16_t FloatToBfloat16(float x) { return RoundToBfloat16(x); }

void Convert(const Shape& shape, const void* from, const Storage& from_storage, void* to,
             const Storage& to_storage) {
  WithCodec(from_storage, [&](const auto& source) {
    WithCodec(to_storage, [&](const auto& target) {
      ConvertElements(shape, from, source, from_storage.channels_last, to, target,
                      to_storage.channels_last);
    });
  });
}

void CopyChannels(const uint8_t* from, const ChannelRun& source, uint8_t* to,
                  const ChannelRun& target, size_t run_bytes, size_t pixels) {
  from += source.first_byte;
  to += target.first_byte;
  const auto copy = [&](auto bytes) {
    for (size_t p = 0; p < pixels; ++p) {
      std::memcpy(to + p * target.pixel_bytes, from + p * source.pixel_bytes, bytes);
    }
  };
  switch (run_bytes) {  // sizes known to the compiler become single moves
    case 8:
      return copy(std::integral_constant<size_t, 8>());
    case 16:
      return copy(std::integral_constant<size_t, 16>());
    case 32:
      return copy(std::integral_constant<size_t, 32>());
    case 64:
      return copy(std::integral_constant<size_t, 64>());
    case 128:
      return copy(std::integral_constant<size_t, 128>());
    default:
      return copy(run_bytes);
  }
}

void RepeatPixels(const uint8_t* from, size_t height, size_t width, size_t pixel_bytes,
                  size_t factor_y, size_t factor_x, uint8_t* to) {
  const size_t row_bytes = width * factor_x * pixel_bytes;
  for (size_t y = 0; y < height; ++y) {
    uint8_t* row = to + y * factor_y * row_bytes;
    uint8_t* pixel = row;
    for (size_t x = 0; x < width; ++x, from += pixel_bytes) {
      for (size_t i = 0; i < factor_x; ++i, pixel += pixel_bytes)
        std::memcpy(pixel, from, pixel_bytes);
    }
    for (size_t i = 1; i < factor_y; ++i) std::memcpy(row + i * row_bytes, row, row_bytes);
  }
}

}  // namespace msf
