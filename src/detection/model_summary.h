// What a model consists of and costs.
#pragma once

#include <string>
#include <vector>

#include "detection/graph.h"

namespace msf {

struct LayerSummary {
  std::string name;
  std::string type;  // "Conv 3x3/2", "MaxPool 5x5", "Concat", ...
  Shape output;
  int64_t parameters = 0;
  int64_t flops = 0;  // 2 per multiply-add
};

struct ModelSummary {
  std::string source;
  std::vector<LayerSummary> layers;
  int64_t parameters = 0;  // weights and biases, with batch norms folded in as the file has them
  int64_t flops = 0;
};

// For images of height x width. Counted are convolutions, matrix products, norms (2 per element),
// sums and averages.
StatusOr<ModelSummary> Summarize(const Graph& graph, int64_t height, int64_t width);

// A table with the totals below.
std::string FormatSummary(const ModelSummary& summary);

}  // namespace msf
