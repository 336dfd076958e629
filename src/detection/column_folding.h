// Convolutions with few channels as convolutions with more channels on a narrower image.
#pragma once

#include "detection/dnnl_steps.h"

namespace msf {

// How many neighbouring output pixels of a row to treat as one with as many times the channels; 1:
// leave it. Matrix units multiply blocks of 16 and more channels; the first layers of a detector
// have 3 to 8 and leave them idle.
int FoldingFactor(const ConvolutionSpec& spec);

// The same convolution in other terms: where the image lies channels last, `factor` * stride
// neighbouring input pixels of a row are one pixel with that many times the channels, and `factor`
// output pixels are one. No number moves in memory; only the weights are spread out over the larger
// kernel, with zeros. `weights` and `bias` receive what the returned spec points to.
ConvolutionSpec FoldColumns(const ConvolutionSpec& spec, int factor, Tensor& weights, Tensor& bias);

}  // namespace msf
