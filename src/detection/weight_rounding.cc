#include "detection/weight_rounding.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace msf {
namespace {

// By how much rounding shifts the mean of each output channel; `means`: per input channel.
std::vector<float> MeanShift(const Tensor& weights, int64_t group, const std::vector<float>& means,
                             int largest) {
  const RoundedWeights rounded = RoundWeights(weights, largest);
  const size_t out = static_cast<size_t>(weights.shape[0]),
               in = static_cast<size_t>(weights.shape[1]),
               window = static_cast<size_t>(weights.shape[2] * weights.shape[3]),
               out_per_group = out / static_cast<size_t>(group);
  std::vector<float> shift(out, 0.0f);
  for (size_t o = 0; o < out; ++o) {
    const size_t first_input = o / out_per_group * in;
    for (size_t i = 0; i < in * window; ++i) {
      const size_t k = o * in * window + i;
      const float weight = rounded.scales[o] * static_cast<float>(rounded.values[k]);
      shift[o] += (weight - weights.floats[k]) * means[first_input + i / window];
    }
  }
  return shift;
}

// Gives a convolution a bias of its own, lessened by `shift`.
void LessenBias(Graph& graph, Node& node, const std::vector<float>& shift) {
  Tensor bias =
      Tensor::Floats({static_cast<int64_t>(shift.size())}, std::vector<float>(shift.size(), 0.0f));
  if (node.inputs.size() > 2 && node.inputs[2] != kNoValue)
    bias = *graph.value(node.inputs[2]).constant;
  for (size_t o = 0; o < shift.size(); ++o) bias.floats[o] -= shift[o];
  Value value;
  value.name = graph.value(node.outputs[0]).name + " corrected bias";
  value.shape_known = true;
  value.shape = bias.shape;
  value.constant = std::make_shared<Tensor>(std::move(bias));
  graph.values.push_back(std::move(value));
  node.inputs.resize(std::max<size_t>(node.inputs.size(), 3), kNoValue);
  node.inputs[2] = static_cast<ValueId>(graph.values.size()) - 1;
}

}  // namespace

RoundedWeights RoundWeights(const Tensor& weights, int largest) {
  const size_t channels = static_cast<size_t>(weights.shape[0]);
  const size_t per_channel = weights.floats.size() / channels;
  RoundedWeights rounded;
  rounded.values.resize(weights.floats.size());
  for (size_t c = 0; c < channels; ++c) {
    const float* w = weights.floats.data() + c * per_channel;
    float peak = 0, sum = 0;
    for (size_t i = 0; i < per_channel; ++i) peak = std::max(peak, std::abs(w[i]));
    const float scale = peak > 0 ? peak / static_cast<float>(largest) : 1.0f;
    for (size_t i = 0; i < per_channel; ++i) {
      const float nearest = std::nearbyint(w[i] / scale);
      rounded.values[c * per_channel + i] = static_cast<int8_t>(nearest);
      sum += nearest;
    }
    rounded.scales.push_back(scale);
    rounded.sums.push_back(sum);
  }
  return rounded;
}

Status CorrectRoundedWeights(Graph& graph, const StoragePlan& plan, const ActivationRanges& ranges,
                             int largest) {
  for (size_t i = 0; i < graph.nodes.size(); ++i) {
    if (plan.kinds[i] != NodeKind::kConvolution || plan.compute[i] != NumberFormat::kUint8)
      continue;
    Node& node = graph.nodes[i];
    const Value& input = graph.value(node.inputs[0]);
    const auto known = ranges.find(input.name);
    if (known == ranges.end() || known->second.means.empty()) continue;
    const std::vector<float>& means = known->second.means;
    if (static_cast<int64_t>(means.size()) != input.shape[1]) {
      return Status::Error(fmt::format(
          "{}: {} reads {} channels but the model holds the means of {}; quantise it again",
          graph.source, Describe(node), input.shape[1], means.size()));
    }
    const std::shared_ptr<const Tensor> weights = graph.value(node.inputs[1]).constant;
    LessenBias(graph, node, MeanShift(*weights, node.Int("group", 1), means, largest));
  }
  return Status::Ok();
}

}  // namespace msf
