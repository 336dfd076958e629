#include "detection/specialize.h"

#include <fmt/format.h>

#include <algorithm>

#include "detection/operators.h"

namespace msf {
namespace {

// More numbers than this do not come from shape arithmetic or anchors but from a damaged file.
constexpr int64_t kMaxFoldedElements = int64_t{1} << 25;

bool TooHeavyToFold(const std::string& op) {
  return op == "Conv" || op == "MatMul" || op == "MaxPool" || op == "AveragePool";
}

class Folder {
 public:
  explicit Folder(Graph& graph) : graph_(graph) {}

  Status Run() {
    std::vector<Node> remaining;
    for (Node& node : graph_.nodes) {
      StatusOr<bool> folded = Visit(node);
      if (!folded.ok()) return Status::Error(graph_.source + ": " + folded.message());
      if (!*folded) remaining.push_back(std::move(node));
    }
    graph_.nodes = std::move(remaining);
    return Status::Ok();
  }

 private:
  // Sets the shapes of the node's outputs; true when it was replaced by constants.
  StatusOr<bool> Visit(const Node& node) {
    InferContext context{node, graph_.opset, {}};
    bool constant = true;
    for (const ValueId id : node.inputs) {
      context.inputs.emplace_back();
      if (id == kNoValue) continue;
      const Value& value = graph_.value(id);
      context.inputs.back() = {true, value.shape, value.type, value.constant.get()};
      constant = constant && value.constant;
    }
    StatusOr<std::vector<ResultInfo>> results = InferShapes(context);
    if (!results.ok()) return results.status();
    int64_t count = 0;
    for (size_t i = 0; i < node.outputs.size(); ++i) {
      Value& value = graph_.value(node.outputs[i]);
      value.shape = (*results)[i].shape;
      value.type = (*results)[i].type;
      value.shape_known = true;
      count += NumElements(value.shape);
    }
    if (node.op == "Shape") constant = true;
    if (!constant || TooHeavyToFold(node.op)) return false;
    folded_ += count;
    if (folded_ > kMaxFoldedElements)
      return Status::Error(Describe(node) + " makes constants too large");
    if (Status status = Fold(node); !status.ok()) {
      return Status::Error(Describe(node) + " " + status.message());
    }
    return true;
  }

  Status Fold(const Node& node) {
    ComputeContext context{node, graph_.opset, {}, {}};
    for (const ValueId id : node.inputs) {
      context.inputs.emplace_back();
      if (id == kNoValue) continue;
      InputView& view = context.inputs.back();
      if (graph_.IsConstant(id)) {
        view = InputView(*graph_.value(id).constant);
      } else {  // of Shape: only the shape is there
        view.present = true;
        view.shape = graph_.value(id).shape;
      }
    }
    std::vector<Tensor> results;
    for (const ValueId id : node.outputs) {
      results.push_back(Tensor::Zeros(graph_.value(id).type, graph_.value(id).shape));
    }
    for (Tensor& result : results) context.outputs.emplace_back(result);
    MSF_RETURN_IF_ERROR(FindOperator(node.op)->compute(context));
    for (size_t i = 0; i < results.size(); ++i) {
      graph_.value(node.outputs[i]).constant =
          std::make_shared<const Tensor>(std::move(results[i]));
    }
    return Status::Ok();
  }

  Graph& graph_;
  int64_t folded_ = 0;
};

}  // namespace

StatusOr<InputSize> DeclaredInputSize(const Graph& graph) {
  const Value& input = graph.value(graph.inputs[0]);
  if (input.shape.empty()) return InputSize{};
  const Shape& s = input.shape;
  if (s.size() != 4 || (s[0] != 1 && s[0] != -1) || (s[1] != 3 && s[1] != -1)) {
    return Status::Error(fmt::format("{}: input '{}' has the shape {}, a detector takes 1x3xHxW",
                                     graph.source, input.name, ToString(s)));
  }
  return InputSize{s[2], s[3]};
}

StatusOr<Graph> Specialize(Graph graph, int64_t height, int64_t width) {
  StatusOr<InputSize> declared = DeclaredInputSize(graph);
  if (!declared.ok()) return declared.status();
  const auto fits = [](int64_t wanted, int64_t fixed) { return fixed == -1 || fixed == wanted; };
  if (!fits(height, declared->height) || !fits(width, declared->width)) {
    return Status::Error(
        fmt::format("{}: was exported for images of {}x{} only and cannot run at {}x{}; use its "
                    "own size or export with open sizes",
                    graph.source, declared->width, declared->height, width, height));
  }
  Value& input = graph.value(graph.inputs[0]);
  input.shape = {1, 3, height, width};
  input.shape_known = true;
  MSF_RETURN_IF_ERROR(Folder(graph).Run());
  for (const ValueId output : graph.outputs) {
    const Value& value = graph.value(output);
    if (value.constant || value.type != ElementType::kFloat) {
      return Status::Error(
          fmt::format("{}: output '{}' does not depend on the image", graph.source, value.name));
    }
  }
  return graph;
}

}  // namespace msf
