#include "detection/branch_merging.h"

#include <algorithm>

#include "detection/graph_rewriter.h"

namespace msf {
namespace {

const Tensor& Weights(const Graph& graph, const Node& conv) {
  return *graph.value(conv.inputs[1]).constant;
}

bool HasConstantWeights(const Graph& graph, const Node& conv) {
  return std::all_of(conv.inputs.begin() + 1, conv.inputs.end(),
                     [&](ValueId id) { return id == kNoValue || graph.IsConstant(id); });
}

// Stride and dilation 1, an odd kernel and padding that keeps the size.
bool KeepsSize(const Graph& graph, const Node& conv) {
  const Shape& w = Weights(graph, conv).shape;
  const std::vector<int64_t> pads = conv.Ints("pads", {0, 0, 0, 0});
  return w[2] == w[3] && w[2] % 2 == 1 && pads == std::vector<int64_t>(4, w[2] / 2) &&
         conv.Ints("strides", {1, 1}) == std::vector<int64_t>{1, 1} &&
         conv.Ints("dilations", {1, 1}) == std::vector<int64_t>{1, 1} &&
         conv.String("auto_pad", "NOTSET") == "NOTSET";
}

bool IsPlainConv(const Graph& graph, const Node& node) {
  return node.op == "Conv" && HasConstantWeights(graph, node) && KeepsSize(graph, node);
}

std::vector<float> Bias(const Graph& graph, const Node& conv) {
  if (conv.inputs.size() > 2 && conv.inputs[2] != kNoValue)
    return graph.value(conv.inputs[2]).constant->floats;
  return std::vector<float>(static_cast<size_t>(Weights(graph, conv).shape[0]), 0.0f);
}

bool IsLinear(const Epilogue& e) {
  return e.addend == kNoValue && e.activation == Activation::kNone && e.scale.empty() &&
         e.shift.empty();
}

void SetKernel(Graph& graph, Node& conv, Tensor weights, std::vector<float> bias) {
  const int64_t kernel = weights.shape[2];
  const Shape channels{weights.shape[0]};
  conv.attributes["kernel_shape"] = std::vector<int64_t>{kernel, kernel};
  conv.attributes["pads"] = std::vector<int64_t>(4, kernel / 2);
  conv.attributes["group"] = int64_t{1};
  conv.inputs.resize(3);
  conv.inputs[1] = graph.AddConstant(conv.name + "/merged", std::move(weights));
  conv.inputs[2] =
      graph.AddConstant(conv.name + "/bias", Tensor::Floats(channels, std::move(bias)));
}

// Makes the 1x1 convolution at `index` do the depthwise one before it as well.
void MergeDepthwise(GraphRewriter& rewriter, int index) {
  Graph& graph = rewriter.graph();
  Node& point = rewriter.node(index);
  if (!IsPlainConv(graph, point) || point.Int("group", 1) != 1 ||
      Weights(graph, point).shape[2] != 1)
    return;
  const int before = rewriter.OnlyFedBy(point.inputs[0], "Conv");
  if (before < 0 || !IsPlainConv(graph, rewriter.node(before))) return;
  const Node depth = rewriter.node(before);
  const Tensor d = Weights(graph, depth), p = Weights(graph, point);
  const int64_t channels = p.shape[1], kernel = d.shape[2];
  if (!IsLinear(depth.epilogue) || depth.Int("group", 1) != channels || d.shape[0] != channels ||
      kernel == 1)
    return;
  Tensor merged = Tensor::Zeros(ElementType::kFloat, {p.shape[0], channels, kernel, kernel});
  const size_t area = static_cast<size_t>(kernel * kernel);
  for (size_t i = 0; i < merged.floats.size(); ++i) {
    const size_t pair = i / area;  // output channel and input channel
    merged.floats[i] =
        p.floats[pair] * d.floats[pair % static_cast<size_t>(channels) * area + i % area];
  }
  std::vector<float> bias = Bias(graph, point);
  const std::vector<float> depth_bias = Bias(graph, depth);
  for (size_t i = 0; i < p.floats.size(); ++i) {
    bias[i / depth_bias.size()] += p.floats[i] * depth_bias[i % depth_bias.size()];
  }
  point.inputs[0] = depth.inputs[0];
  SetKernel(graph, point, std::move(merged), std::move(bias));
  rewriter.Remove(before);
}

bool SameEpilogue(const Epilogue& a, const Epilogue& b) {
  return a.activation == b.activation && a.alpha == b.alpha && a.add_first == b.add_first &&
         (a.addend == kNoValue) == (b.addend == kNoValue) && a.scale.empty() == b.scale.empty() &&
         a.shift.empty() == b.shift.empty();
}

// The branches of a concatenation when they can be merged; empty otherwise.
std::vector<int> Branches(GraphRewriter& rewriter, const Node& concat) {
  const Graph& graph = rewriter.graph();
  if (concat.op != "Concat" || concat.Int("axis", 1) != 1 || concat.inputs.size() < 2) return {};
  std::vector<int> branches;
  for (const ValueId piece : concat.inputs) {
    const int branch = rewriter.OnlyFedBy(piece, "Conv");
    if (branch < 0) return {};
    const Node& conv = rewriter.node(branch);
    const Node& first = branches.empty() ? conv : rewriter.node(branches[0]);
    if (!IsPlainConv(graph, conv) || conv.Int("group", 1) != 1 || conv.inputs[0] != first.inputs[0])
      return {};
    if (!SameEpilogue(conv.epilogue, first.epilogue)) return {};
    branches.push_back(branch);
  }
  return branches;
}

void Append(std::vector<float>& all, const std::vector<float>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

// Copies a kernel into the middle of a larger one, output channels from `first` on.
void Embed(const Tensor& from, int64_t first, Tensor& to) {
  const int64_t k = from.shape[2], size = to.shape[2], margin = (size - k) / 2;
  for (size_t i = 0; i < from.floats.size(); ++i) {
    const int64_t at = static_cast<int64_t>(i), plane = at / (k * k), row = at / k % k,
                  col = at % k;
    const int64_t target =
        ((first * to.shape[1] + plane) * size + row + margin) * size + col + margin;
    to.floats[static_cast<size_t>(target)] = from.floats[i];
  }
}

// One value that holds the addends of all branches.
ValueId JoinAddends(GraphRewriter& rewriter, const std::vector<int>& branches, const Node& concat) {
  Graph& graph = rewriter.graph();
  Node join;
  join.op = "Concat";
  join.name = concat.name + "/addends";
  join.attributes["axis"] = int64_t{1};
  for (const int branch : branches) join.inputs.push_back(rewriter.node(branch).epilogue.addend);
  const ValueId joined = graph.AddValue(join.name);
  graph.value(joined).shape = graph.value(concat.outputs[0]).shape;
  graph.value(joined).shape_known = true;
  join.outputs = {joined};
  rewriter.Add(std::move(join));
  return joined;
}

void MergeConcat(GraphRewriter& rewriter, int index) {
  Graph& graph = rewriter.graph();
  const Node concat = rewriter.node(index);
  const std::vector<int> branches = Branches(rewriter, concat);
  if (branches.empty()) return;
  Node merged = rewriter.node(branches[0]);
  int64_t kernel = 1;
  for (const int branch : branches)
    kernel = std::max(kernel, Weights(graph, rewriter.node(branch)).shape[2]);
  const int64_t in = Weights(graph, merged).shape[1];
  Tensor weights = Tensor::Zeros(ElementType::kFloat,
                                 {graph.value(concat.outputs[0]).shape[1], in, kernel, kernel});
  std::vector<float> bias, scale, shift;
  for (const int branch : branches) {
    const Node& conv = rewriter.node(branch);
    Embed(Weights(graph, conv), static_cast<int64_t>(bias.size()), weights);
    Append(bias, Bias(graph, conv));
    Append(scale, conv.epilogue.scale);
    Append(shift, conv.epilogue.shift);
  }
  merged.epilogue.scale = scale;
  merged.epilogue.shift = shift;
  if (merged.epilogue.addend != kNoValue)
    merged.epilogue.addend = JoinAddends(rewriter, branches, concat);
  merged.outputs = {concat.outputs[0]};
  SetKernel(graph, merged, std::move(weights), std::move(bias));
  for (const int branch : branches) rewriter.Remove(branch);
  rewriter.node(index) = merged;
}

}  // namespace

void MergeBranches(Graph& graph) {
  GraphRewriter rewriter(graph);
  for (const int i : rewriter.LiveNodes()) MergeDepthwise(rewriter, i);
  rewriter.Sort();
  for (const int i : rewriter.LiveNodes()) MergeConcat(rewriter, i);
  rewriter.Sort();
}

}  // namespace msf
