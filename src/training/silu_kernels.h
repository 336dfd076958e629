// The loops behind FastSilu, apart from libtorch's headers so that the compiler can be told to
// vectorise them.
#pragma once

#include <cstddef>
#include <cstdint>

namespace msf {

// y = x * sigmoid(x).
void SiluForward(const float* x, float* y, size_t count);
void SiluForward(const uint16_t* x, uint16_t* y, size_t count);  // bfloat16

// d/dx, times `gradient`.
void SiluBackward(const float* x, const float* gradient, float* result, size_t count);
void SiluBackward(const uint16_t* x, const uint16_t* gradient, uint16_t* result, size_t count);

}  // namespace msf
