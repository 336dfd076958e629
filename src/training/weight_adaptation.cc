#include "training/weight_adaptation.h"

#include <torch/types.h>
#include <torch/utils.h>

#include <algorithm>

#include "training/model_config.h"

namespace msf {

namespace {

// Row of each of the target's classes among the source's.
StatusOr<torch::Tensor> MapRows(int64_t source_rows, const ModelGraph& target) {
  const auto classes = static_cast<int64_t>(target.classes.size());
  if (source_rows == classes) return torch::arange(classes);
  const std::vector<std::string>& coco = CocoClasses();
  if (source_rows != static_cast<int64_t>(coco.size())) {
    return Status::Error("the weights have " + std::to_string(source_rows) + " classes; model " +
                         target.name + " needs " + std::to_string(classes) + " or the 80 of COCO");
  }
  std::vector<int64_t> rows;
  for (const std::string& name : target.classes) {
    const auto found = std::find(coco.begin(), coco.end(), CocoNameOf(name));
    if (found == coco.end())
      return Status::Error("class '" + name + "' has no counterpart among the 80 COCO classes");
    rows.push_back(found - coco.begin());
  }
  return torch::tensor(rows);
}

// Keeps the `count` channels of the block `prefix` (convolution + norm) that weigh most in
// `next_weight`; returns their indices.
torch::Tensor KeepChannels(NamedTensors& state, const std::string& prefix,
                           const torch::Tensor& next_weight, int64_t count) {
  const torch::Tensor influence =
      next_weight.abs().sum({0, 2, 3}) * state[prefix + ".bn.weight"].abs();
  const torch::Tensor kept =
      std::get<0>(std::get<1>(influence.topk(std::min(count, influence.size(0)))).sort());
  for (const char* name :
       {".conv.weight", ".bn.weight", ".bn.bias", ".bn.running_mean", ".bn.running_var"}) {
    state[prefix + name] = state[prefix + name].index_select(0, kept);
  }
  return kept;
}

}  // namespace

StatusOr<NamedTensors> AdaptWeights(const NamedTensors& source, const ModelGraph& target) {
  NamedTensors state = source;
  for (int head : target.class_heads) {
    const GraphNode& last = target.nodes[head];
    const std::string prefix = last.name.substr(0, last.name.size() - 2);
    if (!source.contains(last.name + ".weight") || !source.contains(prefix + ".1.conv.weight")) {
      return Status::Error("the weights have no class head " + last.name +
                           "; are they of a YOLOv8n-like detector?");
    }
    const StatusOr<torch::Tensor> rows = MapRows(source.at(last.name + ".weight").size(0), target);
    if (!rows.ok()) return rows.status();
    torch::Tensor& weight = state[last.name + ".weight"];
    weight = weight.index_select(0, *rows);
    state[last.name + ".bias"] = state[last.name + ".bias"].index_select(0, *rows);

    const int64_t width = target.nodes[last.inputs[0]].channels;
    weight = weight.index_select(1, KeepChannels(state, prefix + ".1", weight, width));
    torch::Tensor& middle = state[prefix + ".1.conv.weight"];
    middle = middle.index_select(1, KeepChannels(state, prefix + ".0", middle, width));
  }
  return state;
}

StatusOr<NamedTensors> BlendWeights(const NamedTensors& a, const NamedTensors& b, double share) {
  NamedTensors blended;
  for (const auto& [name, tensor] : a) {
    const auto other = b.find(name);
    if (other == b.end() || other->second.sizes() != tensor.sizes())
      return Status::Error("the weights to be blended are of different models: tensor " + name +
                           " differs");
    blended[name] = at::lerp(tensor.to(torch::kFloat), other->second.to(torch::kFloat), share);
  }
  return blended;
}

}  // namespace msf
