#include "training/silu_kernels.h"

#include <bit>

namespace msf {

namespace {

// exp(-x) as 2^(whole + part), the part by a polynomial (Taylor of 2^t on [-0.5, 0.5], degree 6).
inline float ExpOfMinus(float x) {
  constexpr float kLog2E = 1.44269504F,
                  kRound = 12582912.0F;  // adding 1.5 * 2^23 rounds to a whole number
  float t = -x * kLog2E;
  t = t < -120.0F ? -120.0F : t;
  t = t > 120.0F ? 120.0F : t;
  const float whole = (t + kRound) - kRound;
  const float u = (t - whole) * 0.69314718F;
  const float p =
      1.0F +
      u * (1.0F + u * (0.5F + u * (0.16666667F +
                                   u * (0.041666667F + u * (0.0083333333F + u * 0.0013888889F)))));
  const int32_t exponent = (static_cast<int32_t>(whole) + 127) << 23;
  return p * std::bit_cast<float>(exponent);
}

inline float ToFloat(float value) { return value; }
inline float ToFloat(uint16_t value) {
  return std::bit_cast<float>(static_cast<uint32_t>(value) << 16);
}

inline void Store(float value, float& target) { target = value; }
inline void Store(float value, uint16_t& target) {
  const uint32_t bits = std::bit_cast<uint32_t>(value);
  target = static_cast<uint16_t>((bits + 0x7FFFU + ((bits >> 16) & 1U)) >>
                                 16);  // to nearest, ties to even
}

template <typename T>
void Forward(const T* __restrict x, T* __restrict y, size_t count) {
  for (size_t i = 0; i < count; ++i) {
    const float v = ToFloat(x[i]);
    Store(v / (1.0F + ExpOfMinus(v)), y[i]);
  }
}

template <typename T>
void Backward(const T* __restrict x, const T* __restrict gradient, T* __restrict result,
              size_t count) {
  for (size_t i = 0; i < count; ++i) {
    const float v = ToFloat(x[i]);
    const float s = 1.0F / (1.0F + ExpOfMinus(v));
    Store(ToFloat(gradient[i]) * s * (1.0F + v * (1.0F - s)), result[i]);
  }
}

}  // namespace

void SiluForward(const float* x, float* y, size_t count) { Forward(x, y, count); }
void SiluForward(const uint16_t* x, uint16_t* y, size_t count) { Forward(x, y, count); }
void SiluBackward(const float* x, const float* g, float* r, size_t count) {
  Backward(x, g, r, count);
}
void SiluBackward(const uint16_t* x, const uint16_t* g, uint16_t* r, size_t count) {
  Backward(x, g, r, count);
}

}  // namespace msf
