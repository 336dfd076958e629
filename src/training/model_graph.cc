#include "training/model_graph.h"

#include "util/check.h"

namespace msf {

int64_t CountParameters(const ModelGraph& graph, const GraphNode& node) {
  if (node.op == GraphOp::kNorm) return 2 * node.channels;
  if (node.op != GraphOp::kConv) return 0;
  const int64_t in = graph.nodes[node.inputs[0]].channels;
  const int64_t weights = in / node.groups * node.channels * node.kernel * node.kernel;
  if (node.normalized) return weights + (node.activated ? 1 : 2) * node.channels;
  return weights + (node.bias ? node.channels : 0);
}

int64_t CountParameters(const ModelGraph& graph) {
  int64_t sum = 0;
  for (const GraphNode& node : graph.nodes) sum += CountParameters(graph, node);
  return sum;
}

int64_t CountFlops(const ModelGraph& graph, const GraphNode& node, int width, int height) {
  const int64_t outputs = int64_t{node.channels} * (width / node.scale) * (height / node.scale);
  const int64_t area = int64_t{node.kernel} * node.kernel;
  switch (node.op) {
    case GraphOp::kConv: {
      const int64_t in = graph.nodes[node.inputs[0]].channels / node.groups;
      return outputs * (2 * in * area + (node.normalized && !node.activated ? 2 : 0));
    }
    case GraphOp::kNorm:
      return 2 * outputs;
    case GraphOp::kAdd:
      return outputs;
    case GraphOp::kAveragePool:
      return area * outputs;
    default:
      return 0;
  }
}

int64_t CountFlops(const ModelGraph& graph, int width, int height) {
  int64_t sum = 0;
  for (const GraphNode& node : graph.nodes) sum += CountFlops(graph, node, width, height);
  return sum;
}

void GraphBuilder::BeginLayer(std::string type) {
  EndLayer();
  graph_.layers.push_back({std::move(type), static_cast<int>(graph_.nodes.size()), 0});
}

void GraphBuilder::EndLayer() {
  if (!graph_.layers.empty()) graph_.layers.back().end = static_cast<int>(graph_.nodes.size());
}

int GraphBuilder::Append(GraphNode node) {
  graph_.nodes.push_back(std::move(node));
  return static_cast<int>(graph_.nodes.size()) - 1;
}

int GraphBuilder::Input() { return Append({}); }

int GraphBuilder::Conv(const std::string& name, int input, int channels, int kernel, int stride) {
  GraphNode conv;
  conv.name = name;
  conv.channels = channels;
  conv.kernel = kernel;
  conv.stride = stride;
  conv.normalized = true;
  conv.activated = true;
  return RawConv(std::move(conv), input);
}

int GraphBuilder::RawConv(GraphNode conv, int input) {
  conv.op = GraphOp::kConv;
  conv.inputs = {input};
  conv.scale = node(input).scale * conv.stride;
  return Append(std::move(conv));
}

int GraphBuilder::Norm(const std::string& name, int input) {
  GraphNode norm = node(input);
  norm = GraphNode{.op = GraphOp::kNorm,
                   .name = name,
                   .inputs = {input},
                   .channels = norm.channels,
                   .scale = norm.scale};
  norm.activated = true;
  return Append(std::move(norm));
}

int GraphBuilder::MaxPool(int input, int kernel, int stride) {
  GraphNode pool{
      .op = GraphOp::kMaxPool, .name = "", .inputs = {input}, .channels = node(input).channels};
  pool.scale = node(input).scale * stride;
  pool.kernel = kernel;
  pool.stride = stride;
  return Append(std::move(pool));
}

int GraphBuilder::AveragePool(int input, int kernel) {
  GraphNode pool{
      .op = GraphOp::kAveragePool, .name = "", .inputs = {input}, .channels = node(input).channels};
  pool.scale = node(input).scale * kernel;
  pool.kernel = kernel;
  pool.stride = kernel;
  return Append(std::move(pool));
}

int GraphBuilder::Upsample(int input) {
  MSF_CHECK(node(input).scale % 2 == 0, "only a halved map can be doubled");
  return Append({.op = GraphOp::kUpsample,
                 .name = "",
                 .inputs = {input},
                 .channels = node(input).channels,
                 .scale = node(input).scale / 2});
}

int GraphBuilder::Concat(const std::vector<int>& inputs) {
  int channels = 0;
  for (int input : inputs) {
    MSF_CHECK(node(input).scale == node(inputs[0]).scale, "concatenated maps need one size");
    channels += node(input).channels;
  }
  return Append({.op = GraphOp::kConcat,
                 .name = "",
                 .inputs = inputs,
                 .channels = channels,
                 .scale = node(inputs[0]).scale});
}

int GraphBuilder::Add(int a, int b) {
  MSF_CHECK(node(a).channels == node(b).channels && node(a).scale == node(b).scale,
            "added maps need one shape");
  return Append({.op = GraphOp::kAdd,
                 .name = "",
                 .inputs = {a, b},
                 .channels = node(a).channels,
                 .scale = node(a).scale});
}

int GraphBuilder::Slice(int input, int begin, int channels) {
  GraphNode slice{.op = GraphOp::kSlice,
                  .name = "",
                  .inputs = {input},
                  .channels = channels,
                  .scale = node(input).scale};
  slice.slice_begin = begin;
  return Append(std::move(slice));
}

}  // namespace msf
