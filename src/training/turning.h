// Turning pictures and maps about their middle, on the tensors of a batch.
#pragma once

#include <torch/types.h>

namespace msf {

// The square maps [batch, channels, side, side], each turned about its middle: what is at c + x in
// the result was at c + R(angle) x in `maps` (image axes: x right, y down). `angles`: [batch],
// radians. Interpolates linearly; what comes from outside is `fill`.
torch::Tensor TurnMaps(const torch::Tensor& maps, const torch::Tensor& angles, double fill);

// Where TurnMaps finds all it needs inside: [batch, 1, side, side], 1 or 0.
torch::Tensor TurnedInside(int64_t side, const torch::Tensor& angles);

}  // namespace msf
