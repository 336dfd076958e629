// Linear algebra on tensors of samples.
#pragma once

#include <torch/types.h>

namespace msf {

// Pixels of a map [batch, channels, h, w] as rows [samples, channels] (float), at most `most` of
// them, evenly spread.
torch::Tensor PixelRows(const torch::Tensor& map, int64_t most);

// X with F X ~ T in the least-squares sense, slightly regularised: [samples, f], [samples, t] ->
// [f, t].
torch::Tensor SolveLeastSquares(const torch::Tensor& features, const torch::Tensor& targets);

// The `count` eigenvectors of a symmetric matrix with the largest eigenvalues, as columns.
torch::Tensor LeadingEigenvectors(const torch::Tensor& symmetric, int64_t count);

}  // namespace msf
