// SiLU, x * sigmoid(x), several times as fast as libtorch 1.13's in bfloat16, where it took 40 % of
// a training step.
#pragma once

#include <torch/types.h>

namespace msf {

// Differentiable; float and bfloat16, any memory format. The exponential is exact to about 1e-7
// relative.
torch::Tensor FastSilu(const torch::Tensor& x);

}  // namespace msf
