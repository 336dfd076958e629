// From raw heads to boxes, differentiably.
#pragma once

#include <torch/types.h>

#include "training/network.h"

namespace msf {

// All scales of a batch in one list of A anchors, in fp32.
struct DecodedHeads {
  torch::Tensor class_logits;  // [batch, A, classes]
  torch::Tensor side_logits;   // [batch, A, 4, kBoxBins]
  torch::Tensor boxes;         // [batch, A, 4]: x0, y0, x1, y1 in pixels
  torch::Tensor anchors;       // [A, 2]: x, y of the cells' centres in pixels
  torch::Tensor strides;       // [A]: pixels per cell
};

// Sides are the expectation over kBoxBins softmax bins times the stride, measured from the cell's
// centre.
DecodedHeads DecodeHeads(const HeadOutputs& heads, int image_width);

}  // namespace msf
