#include "detection/operators.h"

#include <fmt/format.h>

#include <map>

namespace msf {
namespace {

std::map<std::string_view, Operator> AllOperators() {
  std::map<std::string_view, Operator> all;
  for (const auto& family : {ElementwiseOperators(), LayoutOperators(), ShapeOperators(),
                             WindowOperators(), MatrixOperators()}) {
    for (const NamedOperator& entry : family) all.emplace(entry.name, entry.op);
  }
  return all;
}

Status CheckSize(const Shape& shape) {
  int64_t count = 1;
  for (const int64_t size : shape) {
    if (size < 0) return Status::Error("yields the impossible shape " + ToString(shape));
    if (size > kMaxElements || count * size > kMaxElements) {
      return Status::Error("yields " + ToString(shape) + ", which is too large");
    }
    count *= size;
  }
  return Status::Ok();
}

}  // namespace

StatusOr<std::vector<int64_t>> InferContext::ConstantInts(size_t i) const {
  if (!Has(i)) return Status::Error(fmt::format("needs input {}", i));
  if (!inputs[i].constant) {
    return Status::Error(fmt::format("input {} depends on the image, it must be constant", i));
  }
  if (inputs[i].type != ElementType::kInt) {
    return Status::Error(fmt::format("input {} must hold integers", i));
  }
  return inputs[i].constant->ints;
}

const Operator* FindOperator(std::string_view op) {
  static const std::map<std::string_view, Operator> kOperators = AllOperators();
  const auto found = kOperators.find(op);
  return found == kOperators.end() ? nullptr : &found->second;
}

StatusOr<int64_t> NormalizeAxis(int64_t axis, size_t rank) {
  const int64_t n = static_cast<int64_t>(rank);
  if (axis < -n || axis >= n) {
    return Status::Error(fmt::format("axis {} is outside of a tensor with {} dimensions", axis, n));
  }
  return axis < 0 ? axis + n : axis;
}

StatusOr<std::vector<ResultInfo>> InferShapes(const InferContext& context) {
  const Node& node = context.node;
  const auto error = [&](const std::string& why) {
    return Status::Error(Describe(node) + " " + why);
  };
  const Operator* op = FindOperator(node.op);
  if (!op) return error("is not supported");
  if (node.outputs.empty()) return error("has no output");
  const int count = static_cast<int>(context.inputs.size());
  if (count < op->min_inputs || count > op->max_inputs) {
    return error(
        fmt::format("has {} inputs, {} to {} make sense", count, op->min_inputs, op->max_inputs));
  }
  for (int i = 0; i < op->min_inputs; ++i) {
    if (!context.Has(static_cast<size_t>(i))) return error(fmt::format("lacks input {}", i));
  }
  StatusOr<std::vector<ResultInfo>> results = op->infer(context);
  if (!results.ok()) return error(results.message());
  if (node.outputs.size() > results->size()) {
    return error(fmt::format("has {} outputs, expected {}", node.outputs.size(), results->size()));
  }
  for (const ResultInfo& result : *results) {
    if (Status status = CheckSize(result.shape); !status.ok()) return error(status.message());
  }
  return results;
}

}  // namespace msf
