// Decides for a fused graph which kernels run its nodes, in which precision, and how every value is
// stored.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "detection/graph.h"
#include "detection/storage.h"

namespace msf {

enum class NetworkPrecision { kFloat32, kBfloat16, kInt8 };

// What is known of a value from calibration images.
struct ActivationRange {
  float low = 0;  // the span that 8-bit storage represents
  float high = 0;
  std::vector<float> means;  // per channel; empty when unknown
};
// By name of the value.
using ActivationRanges = std::map<std::string, ActivationRange>;

// Kernels, fastest first. All but the last two work on images that lie channels last.
enum class NodeKind {
  kConvolution,  // oneDNN
  kPool,         // oneDNN
  kConcat,       // along the channels
  kSliceChannels,
  kRepeat,       // enlarges by whole factors
  kElementwise,  // plain implementation, indifferent to the order of the elements
  kReference,    // plain implementation, dense row-major float32
};

NodeKind Classify(const Graph& graph, const Node& node);

struct StoragePlan {
  std::vector<NodeKind> kinds;        // per node
  std::vector<NumberFormat> compute;  // per node, of convolutions: the format they multiply in
  std::vector<Storage> storage;       // per value
};

// Values that data movements join (the pieces of a concatenation, the input and output of a pool)
// share one storage, so that moving them is copying. With kInt8 a convolution runs in 8 bits when
// the range of its input is known and no linear convolution made it, unless it is a head: one
// without a nonlinearity behind it that yields the network's outputs stays in the higher precision.
// The convolution that reads the image may run in 8 bits, as 8-bit pixels are exact. `input` is how
// the image is stored.
StoragePlan PlanStorage(const Graph& graph, NetworkPrecision precision,
                        const ActivationRanges& ranges, const Storage& input);

// 8-bit storage that represents `range` extended to contain 0.
Storage QuantizedStorage(const ActivationRange& range);

}  // namespace msf
