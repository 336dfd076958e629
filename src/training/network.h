// A ModelGraph with weights, run by libtorch.
#pragma once

#include <torch/types.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "training/model_graph.h"
#include "util/status.h"

namespace msf {

using NamedTensors = std::map<std::string, torch::Tensor>;

// Raw heads, one tensor per scale (8, 16, 32).
struct HeadOutputs {
  std::vector<torch::Tensor> boxes;    // [batch, 4 * kBoxBins, h, w]
  std::vector<torch::Tensor> classes;  // [batch, classes, h, w]
};

class Network {
 public:
  // Random weights (Kaiming; class biases so that early scores are low), decided by `seed`.
  Network(ModelGraph graph, uint64_t seed);

  const ModelGraph& graph() const { return graph_; }
  // Trained tensors and the running statistics of batch norms, by name ("model.0.conv.weight",
  // "model.0.bn.running_mean", ...).
  const NamedTensors& parameters() const { return parameters_; }
  const NamedTensors& buffers() const { return buffers_; }

  // Whether batch norms use the batch's statistics (and update the running ones) or the running
  // ones.
  void set_training(bool training) { training_ = training; }

  // `images`: [batch, 3, h, w], RGB in [0, 1], h and w multiples of 32.
  HeadOutputs Forward(const torch::Tensor& images) const;

  // Runs the nodes [begin, end) given the values of earlier ones; `values` has one entry per node.
  void RunNodes(int begin, int end, std::vector<torch::Tensor>& values) const;

  HeadOutputs HeadsOf(const std::vector<torch::Tensor>& values) const;

  // Copies of all parameters and buffers, and the way back: every tensor must be there with its
  // shape.
  NamedTensors State() const;
  Status Load(const NamedTensors& state);

  // The tensors for which names and shapes agree are taken; returns the names of those that were
  // not found.
  std::vector<std::string> LoadMatching(const NamedTensors& state);

 private:
  void CreateTensors(const GraphNode& node);
  void CreateNorm(const std::string& prefix, int channels);
  torch::Tensor RunConv(const GraphNode& node, const torch::Tensor& x) const;
  torch::Tensor RunNode(const GraphNode& node, const std::vector<torch::Tensor>& values) const;
  torch::Tensor RunNorm(const std::string& prefix, const torch::Tensor& x) const;

  ModelGraph graph_;
  NamedTensors parameters_;
  NamedTensors buffers_;
  bool training_ = false;
};

inline constexpr double kNormEpsilon = 1e-3;  // of batch norms

// Prefixes of a convolution's weight and of its batch norm: "model.0.conv", "model.0.bn"; a bare
// convolution is just its name.
std::string ConvPrefix(const GraphNode& node);
std::string NormPrefix(const GraphNode& node);

// Reads a dict of tensors written by torch.save or by SaveTensors, as float; of a file whose name
// ends in .onnx see ReadOnnxWeights.
StatusOr<NamedTensors> LoadTensors(const std::filesystem::path& file);
Status SaveTensors(const std::filesystem::path& file, const NamedTensors& tensors);

}  // namespace msf
