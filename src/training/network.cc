#include "training/network.h"

#include <torch/types.h>
#include <torch/utils.h>

#include <cmath>

#include "training/fast_silu.h"
#include "util/check.h"

namespace msf {

namespace {

constexpr double kNormMomentum = 0.03;

}  // namespace

std::string ConvPrefix(const GraphNode& node) {
  return node.normalized ? node.name + ".conv" : node.name;
}

std::string NormPrefix(const GraphNode& node) {
  return node.op == GraphOp::kNorm ? node.name : node.name + ".bn";
}

Network::Network(ModelGraph graph, uint64_t seed) : graph_(std::move(graph)) {
  torch::manual_seed(seed);
  for (const GraphNode& node : graph_.nodes) CreateTensors(node);
  for (size_t i = 0; i < graph_.class_heads.size(); ++i) {
    const GraphNode& box = graph_.nodes[graph_.box_heads[i]];
    const GraphNode& cls = graph_.nodes[graph_.class_heads[i]];
    const double cells = 640.0 / cls.scale;
    const torch::NoGradGuard no_grad;
    parameters_[box.name + ".bias"].fill_(1.0);
    parameters_[cls.name + ".bias"].fill_(std::log(5.0 / cls.channels / (cells * cells)));
  }
}

void Network::CreateTensors(const GraphNode& node) {
  if (node.op == GraphOp::kNorm) CreateNorm(NormPrefix(node), node.channels);
  if (node.op != GraphOp::kConv) return;
  const int in = graph_.nodes[node.inputs[0]].channels / node.groups;
  const double bound = 1.0 / std::sqrt(static_cast<double>(in) * node.kernel * node.kernel);
  torch::Tensor weight =
      torch::empty({node.channels, in, node.kernel, node.kernel}).uniform_(-bound, bound);
  weight = weight.contiguous(torch::MemoryFormat::ChannelsLast);
  parameters_[ConvPrefix(node) + ".weight"] = weight.requires_grad_(true);
  if (node.bias)
    parameters_[ConvPrefix(node) + ".bias"] = torch::zeros({node.channels}).requires_grad_(true);
  if (node.normalized) CreateNorm(NormPrefix(node), node.channels);
}

void Network::CreateNorm(const std::string& prefix, int channels) {
  parameters_[prefix + ".weight"] = torch::ones({channels}).requires_grad_(true);
  parameters_[prefix + ".bias"] = torch::zeros({channels}).requires_grad_(true);
  buffers_[prefix + ".running_mean"] = torch::zeros({channels});
  buffers_[prefix + ".running_var"] = torch::ones({channels});
}

torch::Tensor Network::RunNorm(const std::string& prefix, const torch::Tensor& x) const {
  return at::batch_norm(x, parameters_.at(prefix + ".weight"), parameters_.at(prefix + ".bias"),
                        buffers_.at(prefix + ".running_mean"), buffers_.at(prefix + ".running_var"),
                        training_, kNormMomentum, kNormEpsilon, false);
}

torch::Tensor Network::RunConv(const GraphNode& node, const torch::Tensor& x) const {
  torch::Tensor weight = parameters_.at(ConvPrefix(node) + ".weight");
  torch::Tensor bias = node.bias ? parameters_.at(ConvPrefix(node) + ".bias") : torch::Tensor();
  const int padding = node.kernel / 2;
  if (!node.normalized) return at::conv2d(x, weight, bias, node.stride, padding, 1, node.groups);
  const std::string norm = NormPrefix(node);
  if (training_)
    return RunNorm(norm, at::conv2d(x, weight, bias, node.stride, padding, 1, node.groups));
  // With fixed statistics the norm is a part of the convolution: far less memory traffic, also for
  // the gradients.
  const torch::Tensor scale =
      parameters_.at(norm + ".weight") / (buffers_.at(norm + ".running_var") + kNormEpsilon).sqrt();
  bias = parameters_.at(norm + ".bias") - buffers_.at(norm + ".running_mean") * scale;
  return at::conv2d(x, weight * scale.view({-1, 1, 1, 1}), bias, node.stride, padding, 1,
                    node.groups);
}

torch::Tensor Network::RunNode(const GraphNode& node,
                               const std::vector<torch::Tensor>& values) const {
  const torch::Tensor& x = values[node.inputs[0]];
  switch (node.op) {
    case GraphOp::kConv: {
      const torch::Tensor y = RunConv(node, x);
      return node.activated ? FastSilu(y) : y;
    }
    case GraphOp::kNorm: {
      const torch::Tensor y = RunNorm(NormPrefix(node), x);
      return node.activated ? FastSilu(y) : y;
    }
    case GraphOp::kMaxPool:
      return at::max_pool2d(x, node.kernel, node.stride, node.kernel / 2);
    case GraphOp::kAveragePool:
      return at::avg_pool2d(x, node.kernel, node.stride);
    case GraphOp::kUpsample:
      return at::upsample_nearest2d(x, {2 * x.size(2), 2 * x.size(3)});
    case GraphOp::kConcat: {
      std::vector<torch::Tensor> pieces;
      for (int input : node.inputs) pieces.push_back(values[input]);
      return at::cat(pieces, 1);
    }
    case GraphOp::kAdd:
      return x + values[node.inputs[1]];
    case GraphOp::kSlice:
      return x.narrow(1, node.slice_begin, node.channels);
    case GraphOp::kInput:
      break;
  }
  MSF_CHECK(false, "the input node holds the image and is not run");
}

void Network::RunNodes(int begin, int end, std::vector<torch::Tensor>& values) const {
  for (int i = begin; i < end; ++i) values[i] = RunNode(graph_.nodes[i], values);
}

HeadOutputs Network::HeadsOf(const std::vector<torch::Tensor>& values) const {
  HeadOutputs heads;
  for (int node : graph_.box_heads) heads.boxes.push_back(values[node]);
  for (int node : graph_.class_heads) heads.classes.push_back(values[node]);
  return heads;
}

HeadOutputs Network::Forward(const torch::Tensor& images) const {
  std::vector<torch::Tensor> values(graph_.nodes.size());
  values[0] = images.contiguous(torch::MemoryFormat::ChannelsLast);
  RunNodes(1, static_cast<int>(values.size()), values);
  return HeadsOf(values);
}

NamedTensors Network::State() const {
  NamedTensors state;
  for (const auto& [name, tensor] : parameters_) state[name] = tensor.detach().clone();
  for (const auto& [name, tensor] : buffers_) state[name] = tensor.detach().clone();
  return state;
}

Status Network::Load(const NamedTensors& state) {
  const std::vector<std::string> missing = LoadMatching(state);
  if (missing.empty()) return Status::Ok();
  return Status::Error(
      "the weights do not fit model " + graph_.name + ": " + std::to_string(missing.size()) +
      " tensors are missing or have another shape, the first is " + missing.front());
}

std::vector<std::string> Network::LoadMatching(const NamedTensors& state) {
  const torch::NoGradGuard no_grad;
  std::vector<std::string> missing;
  for (const NamedTensors* own : {&parameters_, &buffers_}) {
    for (const auto& [name, tensor] : *own) {
      const auto found = state.find(name);
      if (found == state.end() || found->second.sizes() != tensor.sizes()) {
        missing.push_back(name);
      } else {
        torch::Tensor target = tensor;
        target.copy_(found->second);
      }
    }
  }
  return missing;
}

}  // namespace msf
