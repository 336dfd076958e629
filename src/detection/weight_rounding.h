// Weights of convolutions as 8-bit numbers, and what that does to the results on average.
#pragma once

#include <cstdint>
#include <vector>

#include "detection/graph.h"
#include "detection/storage_plan.h"
#include "util/status.h"

namespace msf {

// One scale per output channel so that its largest weight becomes `largest`.
struct RoundedWeights {
  std::vector<int8_t> values;  // in the order of the weights
  std::vector<float> scales;   // per output channel: weight = scale * value
  std::vector<float> sums;     // of the values per output channel
};

// `weights`: [out, in / group, height, width]. `largest`: 1..127.
RoundedWeights RoundWeights(const Tensor& weights, int largest);

// Rounded weights shift the mean of every output channel by the sum of (rounded - exact weight) *
// mean input. Where `ranges` knows the means of what an 8-bit convolution of the plan reads, its
// bias takes that back; `largest` as above. An error when a value has more or fewer channels than
// means.
// Source: Nagel et al., Data-free quantization through weight equalization and bias correction,
// ICCV 2019.
Status CorrectRoundedWeights(Graph& graph, const StoragePlan& plan, const ActivationRanges& ranges,
                             int largest);

}  // namespace msf
