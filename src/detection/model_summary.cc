#include "detection/model_summary.h"

#include <fmt/format.h>

#include "detection/specialize.h"
#include "detection/window.h"

namespace msf {
namespace {

std::string WindowText(const std::vector<int64_t>& kernel, const std::vector<int64_t>& strides) {
  if (kernel.size() != 2) return "";
  std::string text = fmt::format(" {}x{}", kernel[0], kernel[1]);
  if (!strides.empty() && strides[0] > 1) text += fmt::format("/{}", strides[0]);
  return text;
}

LayerSummary SummarizeNode(const Graph& graph, const Node& node) {
  LayerSummary layer{node.name, node.op, graph.value(node.outputs[0]).shape, 0, 0};
  const int64_t elements = NumElements(layer.output);
  const bool learned = node.op == "Conv" || node.op == "BatchNormalization";
  for (size_t i = 1; i < node.inputs.size() && learned; ++i) {
    // Of a norm, mean and variance are statistics.
    const bool counts = node.op == "Conv" || i < 3;
    if (counts && graph.IsConstant(node.inputs[i]))
      layer.parameters += NumElements(graph.value(node.inputs[i]).shape);
  }
  std::vector<int64_t> kernel = node.Ints("kernel_shape");
  if (node.op == "Conv") {
    const Shape& weights = graph.value(node.inputs[1]).shape;
    kernel = {weights[2], weights[3]};
    layer.flops = 2 * elements * weights[1] * weights[2] * weights[3];
    if (node.Int("group", 1) > 1) layer.type = "Depthwise";
  }
  if (node.op == "MatMul") layer.flops = 2 * elements * graph.value(node.inputs[0]).shape.back();
  if (node.op == "BatchNormalization") layer.flops = 2 * elements;
  if (node.op == "Add") layer.flops = elements;
  if (node.op == "AveragePool" && kernel.size() == 2)
    layer.flops = elements * kernel[0] * kernel[1];
  layer.type += WindowText(kernel, node.Ints("strides"));
  return layer;
}

}  // namespace

StatusOr<ModelSummary> Summarize(const Graph& graph, int64_t height, int64_t width) {
  StatusOr<InputSize> own = DeclaredInputSize(graph);
  if (!own.ok()) return own.status();
  StatusOr<Graph> fixed = Specialize(graph, own->height > 0 ? own->height : height,
                                     own->width > 0 ? own->width : width);
  if (!fixed.ok()) return fixed.status();
  ModelSummary summary;
  summary.source = graph.source;
  for (const Node& node : fixed->nodes) {
    const LayerSummary layer = SummarizeNode(*fixed, node);
    summary.parameters += layer.parameters;
    summary.flops += layer.flops;
    if (node.op != "Sigmoid" && node.op != "Mul") summary.layers.push_back(layer);
  }
  const Shape& input = fixed->value(fixed->inputs[0]).shape;
  summary.source += " at " + ToString({input[3], input[2]});
  return summary;
}

std::string FormatSummary(const ModelSummary& summary) {
  std::string text = fmt::format("{:>4}  {:<18}{:<20}{:>12}{:>10}  {}\n", "", "layer", "output",
                                 "parameters", "MFLOPs", "name");
  for (size_t i = 0; i < summary.layers.size(); ++i) {
    const LayerSummary& layer = summary.layers[i];
    text += fmt::format("{:>4}  {:<18}{:<20}{:>12}{:>10.1f}  {}\n", i, layer.type,
                        ToString(layer.output), layer.parameters,
                        static_cast<double>(layer.flops) * 1e-6, layer.name);
  }
  return text + fmt::format("{}: {} parameters, {:.3f} GFLOPs\n", summary.source,
                            summary.parameters, static_cast<double>(summary.flops) * 1e-9);
}

}  // namespace msf
