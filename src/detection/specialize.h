// Fixes the input size of a network: all shapes become known and everything that depends only on
// shapes becomes constant.
#pragma once

#include "detection/graph.h"

namespace msf {

// Input size in pixels; -1 where the model leaves it open.
struct InputSize {
  int64_t height = -1;
  int64_t width = -1;
};

// The size that the model file prescribes, or an error when its input is not an image [1, 3, H, W].
StatusOr<InputSize> DeclaredInputSize(const Graph& graph);

// The graph for images of height x width. Afterwards every value has a shape and every remaining
// node depends on the image. An error names the file and, when an operator cannot be used, its
// node.
StatusOr<Graph> Specialize(Graph graph, int64_t height, int64_t width);

}  // namespace msf
