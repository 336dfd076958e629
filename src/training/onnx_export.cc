#include "training/onnx_export.h"

#include <nlohmann/json.hpp>

#include "training/head_decoding.h"
#include "training/onnx_graph.h"
#include "util/atomic_file.h"

namespace msf {

namespace {

constexpr int64_t kOpset = 13;
constexpr int64_t kIrVersion = 7;

// Writes the nodes of a ModelGraph; knows the ONNX name of each node's value.
class GraphExporter {
 public:
  GraphExporter(const ModelGraph& model, const NamedTensors& state, const OnnxOptions& options,
                onnx::GraphProto& proto)
      : model_(model), state_(state), options_(options), onnx_(proto) {
    proto.set_name(model.name);
  }

  void Export() {
    const bool raw = options_.form == OnnxForm::kRawHeads;
    const std::string height = raw ? "height" : std::to_string(options_.height);
    const std::string width = raw ? "width" : std::to_string(options_.width);
    onnx_.Input("images", {"1", "3", height, width});
    for (size_t i = 0; i < model_.nodes.size(); ++i)
      values_.push_back(ExportNode(static_cast<int>(i)));
    if (raw) {
      DeclareHeads();
    } else {
      ExportDecoding();
    }
  }

 private:
  std::string HeadName(int index) const {
    for (size_t i = 0; i < model_.box_heads.size(); ++i) {
      const std::string scale = std::to_string(model_.nodes[model_.box_heads[i]].scale);
      if (model_.box_heads[i] == index) return "box_" + scale;
      if (model_.class_heads[i] == index) return "class_" + scale;
    }
    return "";
  }

  std::string ValueName(int index) const {
    const std::string head = HeadName(index);
    return head.empty() ? "value_" + std::to_string(index) : head;
  }

  std::string ExportNode(int index) {
    const GraphNode& node = model_.nodes[index];
    if (node.op == GraphOp::kInput) return "images";
    std::vector<std::string> inputs;
    for (int input : node.inputs) inputs.push_back(values_[input]);
    const std::string output = ValueName(index);
    const std::string raw = node.activated ? output + "_raw" : output;
    switch (node.op) {
      case GraphOp::kConv:
        ExportConv(node, inputs[0], raw);
        break;
      case GraphOp::kNorm:
        ExportNorm(node, inputs[0], raw);
        break;
      case GraphOp::kMaxPool:
      case GraphOp::kAveragePool:
        ExportPool(node, inputs[0], raw);
        break;
      case GraphOp::kUpsample:
        ExportUpsample(inputs[0], raw);
        break;
      case GraphOp::kConcat:
        onnx_.Concat(inputs, 1, raw);
        break;
      case GraphOp::kAdd:
        onnx_.Node("Add", inputs, raw);
        break;
      case GraphOp::kSlice:
        onnx_.Slice(inputs[0], 1, node.slice_begin, node.slice_begin + node.channels, raw);
        break;
      case GraphOp::kInput:
        break;
    }
    if (node.activated) {
      onnx_.Node("Sigmoid", {raw}, output + "_sigmoid");
      onnx_.Node("Mul", {raw, output + "_sigmoid"}, output);
    }
    return output;
  }

  const torch::Tensor& Tensor(const std::string& name) const { return state_.at(name); }

  void ExportConv(const GraphNode& node, const std::string& input, const std::string& output) {
    torch::Tensor weight = Tensor(ConvPrefix(node) + ".weight");
    torch::Tensor bias = node.bias ? Tensor(ConvPrefix(node) + ".bias") : torch::Tensor();
    if (node.normalized) {
      const std::string norm = NormPrefix(node);
      const torch::Tensor scale =
          Tensor(norm + ".weight") / (Tensor(norm + ".running_var") + kNormEpsilon).sqrt();
      weight = weight * scale.view({-1, 1, 1, 1});
      bias = Tensor(norm + ".bias") - Tensor(norm + ".running_mean") * scale;
    }
    std::vector<std::string> inputs = {
        input, onnx_.Constant(node.name + ".weight", weight, options_.half)};
    if (bias.defined()) inputs.push_back(onnx_.Constant(node.name + ".bias", bias));
    onnx::NodeProto& conv = onnx_.Node("Conv", inputs, output);
    SetWindow(conv, node, node.kernel / 2);
    OnnxGraph::Set(conv, "dilations", std::vector<int64_t>{1, 1});
    OnnxGraph::Set(conv, "group", int64_t{node.groups});
  }

  void ExportNorm(const GraphNode& node, const std::string& input, const std::string& output) {
    std::vector<std::string> inputs = {input};
    for (const char* part : {".weight", ".bias", ".running_mean", ".running_var"}) {
      inputs.push_back(onnx_.Constant(node.name + part, Tensor(node.name + part)));
    }
    OnnxGraph::Set(onnx_.Node("BatchNormalization", inputs, output), "epsilon",
                   static_cast<float>(kNormEpsilon));
  }

  void ExportPool(const GraphNode& node, const std::string& input, const std::string& output) {
    const bool max = node.op == GraphOp::kMaxPool;
    SetWindow(onnx_.Node(max ? "MaxPool" : "AveragePool", {input}, output), node,
              max ? node.kernel / 2 : 0);
  }

  static void SetWindow(onnx::NodeProto& proto, const GraphNode& node, int64_t padding) {
    OnnxGraph::Set(proto, "kernel_shape", std::vector<int64_t>(2, node.kernel));
    OnnxGraph::Set(proto, "strides", std::vector<int64_t>(2, node.stride));
    OnnxGraph::Set(proto, "pads", std::vector<int64_t>(4, padding));
  }

  void ExportUpsample(const std::string& input, const std::string& output) {
    const std::string scales =
        onnx_.Constant(output + "_scales", torch::tensor({1.0F, 1.0F, 2.0F, 2.0F}));
    onnx::NodeProto& resize = onnx_.Node("Resize", {input, "", scales}, output);
    OnnxGraph::Set(resize, "mode", std::string("nearest"));
    OnnxGraph::Set(resize, "coordinate_transformation_mode", std::string("asymmetric"));
    OnnxGraph::Set(resize, "nearest_mode", std::string("floor"));
  }

  void DeclareHeads() {
    for (size_t i = 0; i < model_.box_heads.size(); ++i) {
      for (int head : {model_.box_heads[i], model_.class_heads[i]}) {
        const GraphNode& node = model_.nodes[head];
        const std::string scale = std::to_string(node.scale);
        onnx_.Output(HeadName(head),
                     {"1", std::to_string(node.channels), "height_" + scale, "width_" + scale});
      }
    }
  }

  // Centres of all cells [1, 2, A] in cells, and pixels per cell [1, 4, A].
  std::pair<torch::Tensor, torch::Tensor> Anchors() const {
    std::vector<torch::Tensor> anchors, strides;
    for (int head : model_.box_heads) {
      const int scale = model_.nodes[head].scale;
      const int64_t rows = options_.height / scale, columns = options_.width / scale;
      const torch::Tensor index = at::arange(rows * columns, at::kLong);
      anchors.push_back(at::stack({index.remainder(columns).to(at::kFloat) + 0.5,
                                   index.floor_divide(columns).to(at::kFloat) + 0.5}));
      strides.push_back(at::full({4, rows * columns}, static_cast<double>(scale), at::kFloat));
    }
    return {at::cat(anchors, 1).unsqueeze(0), at::cat(strides, 1).unsqueeze(0)};
  }

  void ExportDecoding() {
    const auto classes = static_cast<int64_t>(model_.classes.size());
    std::vector<std::string> boxes, scores;
    for (size_t i = 0; i < model_.box_heads.size(); ++i) {
      const int scale = model_.nodes[model_.box_heads[i]].scale;
      const int64_t cells = int64_t{options_.height / scale} * (options_.width / scale);
      const std::string box = HeadName(model_.box_heads[i]), cls = HeadName(model_.class_heads[i]);
      boxes.push_back(onnx_.Reshape(box, {1, 4 * kBoxBins, cells}, box + "_flat"));
      scores.push_back(onnx_.Reshape(cls, {1, classes, cells}, cls + "_flat"));
    }
    const auto [anchors, strides] = Anchors();
    const int64_t count = anchors.size(2);
    onnx_.Concat(scores, 2, "class_logits");
    onnx_.Node("Sigmoid", {"class_logits"}, "scores");
    onnx_.Reshape(onnx_.Concat(boxes, 2, "side_logits"), {1, 4, kBoxBins, count}, "side_bins");
    OnnxGraph::Set(onnx_.Node("Transpose", {"side_bins"}, "bins_first"), "perm",
                   std::vector<int64_t>{0, 2, 1, 3});
    OnnxGraph::Set(onnx_.Node("Softmax", {"bins_first"}, "bin_weights"), "axis", int64_t{1});
    const torch::Tensor bins = at::arange(kBoxBins, at::kFloat).view({1, kBoxBins, 1, 1});
    onnx::NodeProto& expectation =
        onnx_.Node("Conv", {"bin_weights", onnx_.Constant("bins", bins)}, "side_rows");
    OnnxGraph::Set(expectation, "kernel_shape", std::vector<int64_t>{1, 1});
    onnx_.Reshape("side_rows", {1, 4, count}, "sides");
    onnx_.Constant("anchors", anchors);
    onnx_.Constant("strides", strides);
    onnx_.Node("Sub", {"anchors", onnx_.Slice("sides", 1, 0, 2, "left_top")}, "corner_min");
    onnx_.Node("Add", {"anchors", onnx_.Slice("sides", 1, 2, 4, "right_bottom")}, "corner_max");
    onnx_.Node("Add", {"corner_min", "corner_max"}, "corner_sum");
    onnx_.Node("Mul",
               {"corner_sum", onnx_.Constant("halves", at::full({1, 2, count}, 0.5, at::kFloat))},
               "centre");
    onnx_.Node("Sub", {"corner_max", "corner_min"}, "size");
    onnx_.Node("Mul", {onnx_.Concat({"centre", "size"}, 1, "cells"), "strides"}, "boxes");
    onnx_.Concat({"boxes", "scores"}, 1, "output0");
    onnx_.Output("output0", {"1", std::to_string(4 + classes), std::to_string(count)});
  }

  const ModelGraph& model_;
  const NamedTensors& state_;
  const OnnxOptions& options_;
  OnnxGraph onnx_;
  std::vector<std::string> values_;
};

}  // namespace

Status ExportOnnx(const ModelGraph& graph, const NamedTensors& state, const OnnxOptions& options,
                  const std::filesystem::path& file) {
  if (options.form == OnnxForm::kSingleOutput &&
      (options.width < 32 || options.width % 32 || options.height < 32 || options.height % 32)) {
    return Status::Error("the input size of a single-output export must be a multiple of 32");
  }
  onnx::ModelProto model;
  model.set_ir_version(kIrVersion);
  model.set_producer_name("msf-slam");
  onnx::OperatorSetIdProto* opset = model.add_opset_import();
  opset->set_domain("");
  opset->set_version(kOpset);
  GraphExporter(graph, state, options, *model.mutable_graph()).Export();
  onnx::StringStringEntryProto* names = model.add_metadata_props();
  names->set_key("names");
  names->set_value(nlohmann::json(graph.classes).dump());
  std::string bytes;
  if (!model.SerializeToString(&bytes))
    return Status::Error(file.string() + ": the model is too large for an ONNX file");
  return WriteFileAtomically(file, bytes);
}

}  // namespace msf
