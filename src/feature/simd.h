// Vectors of bytes for the inner loops over pixels. GCC and Clang translate them for any processor;
// the same templates run on a plain uint8_t for what is narrower than a vector.
#pragma once

#include <cstdint>
#include <cstring>

namespace msf::simd {

using U8x32 [[gnu::vector_size(32)]] = uint8_t;

template <typename V>
inline V Load(const uint8_t* from) {
  V value;
  std::memcpy(&value, from, sizeof(V));
  return value;
}

template <typename V>
inline void Store(uint8_t* to, V value) {
  std::memcpy(to, &value, sizeof(V));
}

template <typename V>
inline V Min(V a, V b) {
  return a < b ? a : b;
}

template <typename V>
inline V Max(V a, V b) {
  return a > b ? a : b;
}

// Calls body(vector type, x) so that every x in [begin, end) is covered: whole vectors, the last
// one shifted back to end at `end` (so some places are done twice), or single bytes where the range
// is narrower than one vector.
template <typename Body>
inline void ForEachBlock(int begin, int end, const Body& body) {
  constexpr int kLanes = sizeof(U8x32);
  if (end - begin < kLanes) {
    for (int x = begin; x < end; ++x) body(uint8_t{}, x);
    return;
  }
  for (int x = begin; x + kLanes <= end; x += kLanes) body(U8x32{}, x);
  if ((end - begin) % kLanes != 0) body(U8x32{}, end - kLanes);
}

}  // namespace msf::simd
