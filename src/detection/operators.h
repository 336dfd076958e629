// The operators a network may contain: for each the shape it yields and a plain implementation that
// serves to fold constants, to run the operators that are too rare to be worth a fast path, and as
// the reference of the tests. Semantics: the ONNX operator specification, opsets 7 to 19; float32
// and integers only.
#pragma once

#include <string_view>
#include <vector>

#include "detection/graph.h"

namespace msf {

// What is known about an operand before anything runs.
struct OperandInfo {
  bool present = false;
  Shape shape;
  ElementType type = ElementType::kFloat;
  const Tensor* constant = nullptr;
};

struct ResultInfo {
  Shape shape;
  ElementType type = ElementType::kFloat;
};

struct InferContext {
  const Node& node;
  int64_t opset;
  std::vector<OperandInfo> inputs;

  bool Has(size_t i) const { return i < inputs.size() && inputs[i].present; }
  const Shape& shape(size_t i) const { return inputs[i].shape; }
  // The integers of a constant input; an error when it is computed at run time.
  StatusOr<std::vector<int64_t>> ConstantInts(size_t i) const;
};

struct ComputeContext {
  const Node& node;
  int64_t opset;
  std::vector<InputView> inputs;
  std::vector<OutputView> outputs;

  bool Has(size_t i) const { return i < inputs.size() && inputs[i].present; }
};

struct Operator {
  int min_inputs;
  int max_inputs;
  // Shapes of the outputs, or why the operands do not fit (a sentence without the node's name).
  StatusOr<std::vector<ResultInfo>> (*infer)(const InferContext&);
  // Fills the outputs, whose shapes come from `infer`.
  Status (*compute)(const ComputeContext&);
};

// Null when the operator is unknown.
const Operator* FindOperator(std::string_view op);

// Larger tensors are refused: they come from damaged files.
inline constexpr int64_t kMaxElements = int64_t{1} << 27;

// Checks count of inputs and outputs, infers and bounds the shapes; errors name the node.
StatusOr<std::vector<ResultInfo>> InferShapes(const InferContext& context);

// For the operator files: -1 counts from the end; an error when outside of [0, rank).
StatusOr<int64_t> NormalizeAxis(int64_t axis, size_t rank);

// The operators by family, one file each.
struct NamedOperator {
  std::string_view name;
  Operator op;
};
std::vector<NamedOperator> ElementwiseOperators();
std::vector<NamedOperator> LayoutOperators();
std::vector<NamedOperator> ShapeOperators();
std::vector<NamedOperator> WindowOperators();
std::vector<NamedOperator> MatrixOperators();

}  // namespace msf
