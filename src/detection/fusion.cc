#include "detection/fusion.h"

#include <algorithm>
#include <cmath>

#include "detection/graph_rewriter.h"

namespace msf {
namespace {

bool IsGraphOutput(const Graph& graph, ValueId value) {
  return std::find(graph.outputs.begin(), graph.outputs.end(), value) != graph.outputs.end();
}

void RemoveOperatorsWithoutEffect(GraphRewriter& rewriter) {
  Graph& graph = rewriter.graph();
  for (const int i : rewriter.LiveNodes()) {
    const Node& node = rewriter.node(i);
    const bool copies = node.op == "Identity" || node.op == "Dropout" || node.op == "Cast" ||
                        node.op == "Reshape" || node.op == "Expand" || node.op == "Concat";
    if (!copies || (node.op == "Concat" && node.inputs.size() != 1)) continue;
    const Value& from = graph.value(node.inputs[0]);
    const Value& to = graph.value(node.outputs[0]);
    if (from.shape != to.shape || from.type != to.type || IsGraphOutput(graph, node.outputs[0]))
      continue;
    rewriter.ReplaceUses(node.outputs[0], node.inputs[0]);
    rewriter.Remove(i);
  }
}

Node CutChannels(const Node& node, size_t part, int64_t first, int64_t count) {
  Node cut;
  cut.op = "SliceChannels";
  cut.name = node.name;
  cut.inputs = {node.inputs[0]};
  cut.outputs = {node.outputs[part]};
  cut.attributes["first"] = first;
  cut.attributes["count"] = count;
  return cut;
}

bool IsAlongChannels(const Node& node, const Shape& shape) {
  const int64_t axis = node.Int("axis", 0);
  return shape.size() == 4 && (axis == 1 || axis == -3);
}

// The first channel that a Slice takes when it takes whole pixels and consecutive channels; -1
// otherwise.
int64_t FirstChannel(const Graph& graph, const Node& slice) {
  const Shape& from = graph.value(slice.inputs[0]).shape;
  const Shape& to = graph.value(slice.outputs[0]).shape;
  if (from.size() != 4 || from[0] != to[0] || from[2] != to[2] || from[3] != to[3]) return -1;
  const auto one = [&](size_t input, const char* key) -> int64_t {
    std::vector<int64_t> values = slice.Ints(key);
    if (input < slice.inputs.size() && graph.IsConstant(slice.inputs[input])) {
      values = graph.value(slice.inputs[input]).constant->ints;
    }
    return values.size() == 1 ? values[0] : -1;
  };
  const bool steps = slice.inputs.size() > 4 && one(4, "steps") != 1;
  const int64_t start = one(1, "starts");
  if (one(3, "axes") != 1 || steps || start < 0 || start + to[1] > from[1]) return -1;
  return start;
}

void RewriteChannelSlices(GraphRewriter& rewriter) {
  Graph& graph = rewriter.graph();
  for (const int i : rewriter.LiveNodes()) {
    const Node node = rewriter.node(i);
    if (node.op == "Split" && IsAlongChannels(node, graph.value(node.inputs[0]).shape)) {
      rewriter.Remove(i);
      int64_t first = 0;
      for (size_t part = 0; part < node.outputs.size(); ++part) {
        const int64_t count = graph.value(node.outputs[part]).shape[1];
        rewriter.Add(CutChannels(node, part, first, count));
        first += count;
      }
    }
    if (node.op == "Slice" && FirstChannel(graph, node) >= 0) {
      const int64_t count = graph.value(node.outputs[0]).shape[1];
      rewriter.node(i) = CutChannels(node, 0, FirstChannel(graph, node), count);
    }
  }
  rewriter.Sort();
}

void FindSilu(GraphRewriter& rewriter) {
  for (const int i : rewriter.LiveNodes()) {
    Node& node = rewriter.node(i);
    if (node.op != "Mul") continue;
    for (size_t gate = 0; gate < 2; ++gate) {
      const ValueId x = node.inputs[1 - gate];
      const int sigmoid = rewriter.Producer(node.inputs[gate]);
      if (sigmoid < 0 || rewriter.node(sigmoid).op != "Sigmoid") continue;
      if (rewriter.node(sigmoid).inputs[0] != x) continue;
      node.op = "Silu";
      node.inputs = {x};
      break;
    }
  }
  rewriter.Sort();
}

void RewriteBatchNorm(GraphRewriter& rewriter) {
  Graph& graph = rewriter.graph();
  for (const int i : rewriter.LiveNodes()) {
    const Node node = rewriter.node(i);
    if (node.op != "BatchNormalization" || node.outputs.size() != 1) continue;
    bool constant = true;
    for (size_t k = 1; k < 5; ++k) constant = constant && graph.IsConstant(node.inputs[k]);
    if (!constant) continue;
    const auto parameter = [&](size_t k) { return graph.value(node.inputs[k]).constant->floats; };
    std::vector<float> scale = parameter(1), shift = parameter(2);
    const std::vector<float> mean = parameter(3), variance = parameter(4);
    const float epsilon = node.Float("epsilon", 1e-5f);
    for (size_t c = 0; c < scale.size(); ++c) {
      scale[c] /= std::sqrt(variance[c] + epsilon);
      shift[c] -= mean[c] * scale[c];
    }
    const Shape shape{static_cast<int64_t>(scale.size())};
    const ValueId scale_id = graph.AddConstant(node.name + "/scale", Tensor::Floats(shape, scale));
    const ValueId shift_id = graph.AddConstant(node.name + "/shift", Tensor::Floats(shape, shift));
    Node& rewritten = rewriter.node(i);
    rewritten.op = "ChannelAffine";
    rewritten.inputs = {node.inputs[0], scale_id, shift_id};
  }
  rewriter.Sort();
}

bool IsActivation(const std::string& op) {
  return op == "Silu" || op == "Relu" || op == "LeakyRelu" || op == "Sigmoid";
}

// The channels [first, first + count) of a constant vector.
ValueId CutConstant(Graph& graph, ValueId id, int64_t first, int64_t count) {
  const std::vector<float>& all = graph.value(id).constant->floats;
  const std::vector<float> part(all.begin() + first, all.begin() + first + count);
  return graph.AddConstant(graph.value(id).name + "/" + std::to_string(first),
                           Tensor::Floats({count}, part));
}

// Whether it pays to apply a map to each piece of a concatenation instead of to the whole.
bool FedByConvolutions(const GraphRewriter& rewriter, const Node& concat, Graph& graph) {
  for (const ValueId piece : concat.inputs) {
    const int producer = rewriter.Producer(piece);
    if (producer < 0 || rewriter.Uses(piece) != 1) return false;
    const std::string& op = graph.nodes[static_cast<size_t>(producer)].op;
    if (op != "Conv" && op != "Add" && op != "ChannelAffine" && op != "Concat") return false;
  }
  return true;
}

// map(concat(a, b)) = concat(map(a), map(b)) along the channels.
bool MoveThroughConcat(GraphRewriter& rewriter, int index) {
  Graph& graph = rewriter.graph();
  const Node map = rewriter.node(index);
  if (!IsActivation(map.op) && map.op != "ChannelAffine") return false;
  const int concat = rewriter.OnlyFedBy(map.inputs[0], "Concat");
  if (concat < 0 || !FedByConvolutions(rewriter, rewriter.node(concat), graph)) return false;
  if (rewriter.node(concat).Int("axis", 1) != 1 || graph.value(map.inputs[0]).shape.size() != 4)
    return false;
  rewriter.Remove(index);
  int64_t first = 0;
  for (size_t i = 0; i < rewriter.node(concat).inputs.size(); ++i) {
    const ValueId piece = rewriter.node(concat).inputs[i];
    const Shape shape = graph.value(piece).shape;
    const ValueId result =
        graph.AddValue(graph.value(map.outputs[0]).name + "/" + std::to_string(i));
    graph.value(result).shape = shape;
    graph.value(result).shape_known = true;
    Node part = map;
    part.name += "/" + std::to_string(i);
    part.inputs[0] = piece;
    for (size_t k = 1; k < part.inputs.size(); ++k) {
      part.inputs[k] = CutConstant(graph, map.inputs[k], first, shape[1]);
    }
    part.outputs = {result};
    rewriter.node(concat).inputs[i] = result;
    rewriter.Add(std::move(part));
    first += shape[1];
  }
  rewriter.RedirectOutput(concat, map.outputs[0]);
  return true;
}

void MoveMapsThroughConcats(GraphRewriter& rewriter) {
  bool changed = true;
  while (changed) {
    changed = false;
    for (const int i : rewriter.LiveNodes()) {
      if (MoveThroughConcat(rewriter, i)) {
        changed = true;
        break;
      }
    }
    rewriter.Sort();
  }
}

// Multiplies the weights and sets the bias so that the convolution yields what it yielded, times
// scale plus shift.
void FoldAffine(Graph& graph, Node& conv, const std::vector<float>& scale,
                const std::vector<float>& shift) {
  Tensor weights = *graph.value(conv.inputs[1]).constant;
  const size_t per_channel = weights.floats.size() / scale.size();
  for (size_t i = 0; i < weights.floats.size(); ++i) weights.floats[i] *= scale[i / per_channel];
  std::vector<float> bias(scale.size(), 0.0f);
  if (conv.inputs.size() > 2 && conv.inputs[2] != kNoValue)
    bias = graph.value(conv.inputs[2]).constant->floats;
  for (size_t c = 0; c < bias.size(); ++c) bias[c] = bias[c] * scale[c] + shift[c];
  const Shape shape{static_cast<int64_t>(bias.size())};
  conv.inputs.resize(3);
  conv.inputs[1] = graph.AddConstant(conv.name + "/weights", std::move(weights));
  conv.inputs[2] = graph.AddConstant(conv.name + "/bias", Tensor::Floats(shape, std::move(bias)));
}

bool AbsorbAffine(Graph& graph, Node& conv, const Node& affine) {
  Epilogue& e = conv.epilogue;
  const std::vector<float>& scale = graph.value(affine.inputs[1]).constant->floats;
  const std::vector<float>& shift = graph.value(affine.inputs[2]).constant->floats;
  if (e.activation != Activation::kNone || !e.scale.empty()) return false;
  if (e.addend == kNoValue) {
    if (scale.empty()) return false;
    FoldAffine(graph, conv, scale, shift);
    return true;
  }
  if (!e.add_first) return false;
  e.scale = scale;
  e.shift = shift;
  return true;
}

bool AbsorbActivation(Node& conv, const Node& activation) {
  Epilogue& e = conv.epilogue;
  if (e.activation != Activation::kNone || (e.addend != kNoValue && !e.add_first)) return false;
  if (activation.op == "Silu") e.activation = Activation::kSilu;
  if (activation.op == "Relu") e.activation = Activation::kRelu;
  if (activation.op == "Sigmoid") e.activation = Activation::kSigmoid;
  if (activation.op == "LeakyRelu") {
    e.activation = Activation::kLeakyRelu;
    e.alpha = activation.Float("alpha", 0.01f);
  }
  return true;
}

bool AbsorbAddition(const Graph& graph, Node& conv, ValueId other) {
  Epilogue& e = conv.epilogue;
  const ValueId own = conv.outputs[0];
  if (e.addend != kNoValue || other == own || graph.IsConstant(other)) return false;
  if (graph.value(other).shape != graph.value(own).shape) return false;
  e.addend = other;
  e.add_first = e.activation == Activation::kNone;
  return true;
}

bool HasConstantWeights(const Graph& graph, const Node& conv) {
  for (size_t i = 1; i < conv.inputs.size(); ++i) {
    if (conv.inputs[i] != kNoValue && !graph.IsConstant(conv.inputs[i])) return false;
  }
  return true;
}

// Lets the convolution that feeds operand `operand` of a node do the node's work; false when it
// cannot.
bool AbsorbIntoConv(GraphRewriter& rewriter, int index, size_t operand) {
  Graph& graph = rewriter.graph();
  const Node node = rewriter.node(index);
  const int feeder = rewriter.OnlyFedBy(node.inputs[operand], "Conv");
  if (feeder < 0 || !HasConstantWeights(graph, rewriter.node(feeder))) return false;
  Node& conv = rewriter.node(feeder);
  bool absorbed = false;
  if (node.op == "ChannelAffine") absorbed = AbsorbAffine(graph, conv, node);
  if (IsActivation(node.op)) absorbed = AbsorbActivation(conv, node);
  if (node.op == "Add") absorbed = AbsorbAddition(graph, conv, node.inputs[1 - operand]);
  if (!absorbed) return false;
  rewriter.Remove(index);
  rewriter.RedirectOutput(feeder, node.outputs[0]);
  return true;
}

void FillConvolutions(GraphRewriter& rewriter) {
  for (const int i : rewriter.LiveNodes()) {
    const std::string op = rewriter.node(i).op;
    if (op == "ChannelAffine" || IsActivation(op)) AbsorbIntoConv(rewriter, i, 0);
    if (op == "Add" && !AbsorbIntoConv(rewriter, i, 0)) AbsorbIntoConv(rewriter, i, 1);
  }
  rewriter.Sort();
}

}  // namespace

void Fuse(Graph& graph) {
  GraphRewriter rewriter(graph);
  RemoveOperatorsWithoutEffect(rewriter);
  rewriter.Sort();
  RewriteChannelSlices(rewriter);
  FindSilu(rewriter);
  RewriteBatchNorm(rewriter);
  MoveMapsThroughConcats(rewriter);
  FillConvolutions(rewriter);
}

}  // namespace msf
