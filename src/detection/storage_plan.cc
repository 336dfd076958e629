#include "detection/storage_plan.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>

#include "detection/dnnl_steps.h"
#include "detection/window.h"

namespace msf {
namespace {

bool IsSingleImage(const Graph& graph, ValueId id) {
  const Shape& shape = graph.value(id).shape;
  return shape.size() == 4 && shape[0] == 1 && NumElements(shape) > 0;
}

bool MovesData(NodeKind kind) {
  return kind == NodeKind::kPool || kind == NodeKind::kConcat || kind == NodeKind::kSliceChannels ||
         kind == NodeKind::kRepeat;
}

bool IsFastConvolution(const Graph& graph, const Node& node) {
  for (size_t i = 1; i < node.inputs.size(); ++i) {
    if (node.inputs[i] != kNoValue && !graph.IsConstant(node.inputs[i])) return false;
  }
  return NumElements(graph.value(node.inputs[1]).shape) > 0;
}

// Pools that ceil_mode extends beyond the padding, or that average over padding, are left to the
// plain implementation.
bool IsFastPool(const Graph& graph, const Node& node) {
  const std::vector<int64_t> kernel = node.Ints("kernel_shape");
  const StatusOr<Window> w =
      ReadWindow(node, graph.value(node.inputs[0]).shape, kernel[0], kernel[1]);
  if (!w.ok() || w->dilation[0] != 1 || w->dilation[1] != 1) return false;
  const int64_t padding = w->pad_begin[0] + w->pad_begin[1] + w->pad_end[0] + w->pad_end[1];
  return node.Int("ceil_mode", 0) == 0 && (node.op == "MaxPool" || padding == 0);
}

bool IsElementwise(const std::string& op) {
  static const std::set<std::string> kOps = {"Sigmoid", "Silu", "Relu",      "LeakyRelu",   "Tanh",
                                             "Exp",     "Sqrt", "HardSwish", "HardSigmoid", "Add",
                                             "Sub",     "Mul",  "Div",       "Neg"};
  return kOps.count(op) > 0;
}

bool AllOfShape(const Graph& graph, const Node& node, const Shape& shape) {
  return std::all_of(node.inputs.begin(), node.inputs.end(), [&](ValueId id) {
    return id != kNoValue && !graph.IsConstant(id) && graph.value(id).shape == shape;
  });
}

class Planner {
 public:
  Planner(const Graph& graph, NetworkPrecision precision, const ActivationRanges& ranges)
      : graph_(graph), precision_(precision), ranges_(ranges), parent_(graph.values.size()) {
    std::iota(parent_.begin(), parent_.end(), 0);
    high_ = precision == NetworkPrecision::kFloat32 ||
                    (precision == NetworkPrecision::kInt8 && !HasFastBfloat16())
                ? NumberFormat::kFloat32
                : NumberFormat::kBfloat16;
  }

  StoragePlan Run(const Storage& input) {
    for (const Node& node : graph_.nodes) plan_.kinds.push_back(Classify(graph_, node));
    FindMakers();
    JoinMovedValues();
    plan_.storage.assign(graph_.values.size(), Storage());
    plan_.storage[static_cast<size_t>(graph_.inputs[0])] = input;
    for (size_t v = 0; v < graph_.values.size(); ++v) {
      if (Root(static_cast<int>(v)) == static_cast<int>(v) &&
          IsFastValue(static_cast<ValueId>(v))) {
        DecideGroup(static_cast<int>(v));
      }
    }
    for (size_t i = 0; i < graph_.nodes.size(); ++i) DecideNode(i);
    return std::move(plan_);
  }

 private:
  void FindMakers() {
    maker_.assign(graph_.values.size(), -1);
    for (size_t i = 0; i < graph_.nodes.size(); ++i) {
      for (const ValueId output : graph_.nodes[i].outputs)
        maker_[static_cast<size_t>(output)] = static_cast<int>(i);
    }
  }

  // Made by a convolution or a data movement.
  bool IsFastValue(ValueId id) const {
    const int maker = maker_[static_cast<size_t>(id)];
    if (maker < 0) return false;
    const NodeKind kind = plan_.kinds[static_cast<size_t>(maker)];
    return kind == NodeKind::kConvolution || MovesData(kind);
  }

  int Root(int value) {
    while (parent_[static_cast<size_t>(value)] != value) {
      int& up = parent_[static_cast<size_t>(value)];
      up = parent_[static_cast<size_t>(up)];
      value = up;
    }
    return value;
  }

  void JoinMovedValues() {
    for (size_t i = 0; i < graph_.nodes.size(); ++i) {
      if (!MovesData(plan_.kinds[i])) continue;
      const Node& node = graph_.nodes[i];
      const int to = Root(node.outputs[0]);
      const size_t operands = plan_.kinds[i] == NodeKind::kConcat ? node.inputs.size() : 1;
      for (size_t k = 0; k < operands; ++k) {
        if (IsFastValue(node.inputs[k])) parent_[static_cast<size_t>(Root(node.inputs[k]))] = to;
      }
    }
  }

  // A convolution that may run in 8 bits as far as accuracy is concerned.
  bool ToleratesInt8(size_t index) const {
    const Node& node = graph_.nodes[index];
    if (precision_ != NetworkPrecision::kInt8 || plan_.kinds[index] != NodeKind::kConvolution)
      return false;
    return !IsHead(node);
  }

  // Yields numbers that no later layer can mend: logits, or what attention compares.
  bool IsHead(const Node& node) const {
    if (node.epilogue.activation != Activation::kNone || node.epilogue.addend != kNoValue)
      return false;
    const ValueId result = node.outputs[0];
    for (size_t i = 0; i < graph_.nodes.size(); ++i) {
      const NodeKind kind = plan_.kinds[i];
      const bool plain = kind == NodeKind::kReference || kind == NodeKind::kElementwise;
      const std::vector<ValueId> reads = graph_.nodes[i].Reads();
      if (!plain && std::count(reads.begin(), reads.end(), result) > 0) return false;
    }
    return true;
  }

  // The storage of all values whose root is `root`.
  void DecideGroup(int root) {
    std::vector<ValueId> members;
    for (size_t v = 0; v < graph_.values.size(); ++v) {
      if (Root(static_cast<int>(v)) == root) members.push_back(static_cast<ValueId>(v));
    }
    bool feeds_int8 = false, feeds_fast = false;
    for (size_t i = 0; i < graph_.nodes.size(); ++i) {
      if (plan_.kinds[i] != NodeKind::kConvolution) continue;
      if (Root(graph_.nodes[i].inputs[0]) != root) continue;
      feeds_fast = true;
      feeds_int8 = feeds_int8 || ToleratesInt8(i);
    }
    const std::optional<ActivationRange> range = RangeOf(members);
    Storage storage;
    if (feeds_fast) storage.format = high_;
    if (feeds_int8 && range) storage = QuantizedStorage(*range);
    storage.channels_last = true;
    for (const ValueId member : members) plan_.storage[static_cast<size_t>(member)] = storage;
  }

  // The hull of the ranges of what convolutions put into a group; none when one of them is unknown
  // or no nonlinearity bounds it.
  std::optional<ActivationRange> RangeOf(const std::vector<ValueId>& members) const {
    ActivationRange hull;
    for (const ValueId member : members) {
      const int maker = maker_[static_cast<size_t>(member)];
      if (plan_.kinds[static_cast<size_t>(maker)] != NodeKind::kConvolution) continue;
      // Without a nonlinearity the numbers spread far to both sides: 256 steps are too coarse for
      // them.
      if (graph_.nodes[static_cast<size_t>(maker)].epilogue.activation == Activation::kNone) {
        return std::nullopt;
      }
      const auto found = ranges_.find(graph_.value(member).name);
      if (found == ranges_.end()) return std::nullopt;
      hull.low = std::min(hull.low, found->second.low);
      hull.high = std::max(hull.high, found->second.high);
    }
    if (hull.low == hull.high) return std::nullopt;
    return hull;
  }

  void DecideNode(size_t index) {
    const Node& node = graph_.nodes[index];
    const bool is_int8 =
        ToleratesInt8(index) &&
        plan_.storage[static_cast<size_t>(node.inputs[0])].format == NumberFormat::kUint8;
    plan_.compute.push_back(is_int8 ? NumberFormat::kUint8 : high_);
    if (plan_.kinds[index] != NodeKind::kElementwise) return;
    for (const ValueId output : node.outputs)
      plan_.storage[static_cast<size_t>(output)].channels_last = true;
  }

  const Graph& graph_;
  const NetworkPrecision precision_;
  const ActivationRanges& ranges_;
  NumberFormat high_;  // where 8 bits are not used
  StoragePlan plan_;
  std::vector<int> maker_;   // node that makes a value, -1 for none
  std::vector<int> parent_;  // union-find over values
};

}  // namespace

NodeKind Classify(const Graph& graph, const Node& node) {
  const ValueId x = node.inputs.empty() ? kNoValue : node.inputs[0];
  if (x == kNoValue || graph.IsConstant(x) || !IsSingleImage(graph, x) ||
      !IsSingleImage(graph, node.outputs[0])) {
    return NodeKind::kReference;
  }
  if (node.op == "Conv" && IsFastConvolution(graph, node)) return NodeKind::kConvolution;
  if ((node.op == "MaxPool" || node.op == "AveragePool") && IsFastPool(graph, node))
    return NodeKind::kPool;
  if (node.op == "SliceChannels") return NodeKind::kSliceChannels;
  if (node.op == "Resize" || node.op == "Upsample") return NodeKind::kRepeat;
  const bool constant_piece = std::any_of(node.inputs.begin(), node.inputs.end(), [&](ValueId id) {
    return graph.IsConstant(id) || !IsSingleImage(graph, id);
  });
  const int64_t axis = node.Int("axis", 1);
  if (node.op == "Concat" && (axis == 1 || axis == -3) && !constant_piece) return NodeKind::kConcat;
  if (IsElementwise(node.op) && AllOfShape(graph, node, graph.value(node.outputs[0]).shape)) {
    return NodeKind::kElementwise;
  }
  return NodeKind::kReference;
}

Storage QuantizedStorage(const ActivationRange& range) {
  const float low = std::min(range.low, 0.0f), high = std::max(range.high, 0.0f);
  Storage storage;
  storage.format = NumberFormat::kUint8;
  storage.scale = (high - low) / 255.0f;
  storage.zero_point = static_cast<int>(std::lround(-low / storage.scale));
  return storage;
}

StoragePlan PlanStorage(const Graph& graph, NetworkPrecision precision,
                        const ActivationRanges& ranges, const Storage& input) {
  return Planner(graph, precision, ranges).Run(input);
}

}  // namespace msf
