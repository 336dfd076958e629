// Operators that treat every element alike.
#include <algorithm>
#include <cmath>
#include <limits>

#include "detection/broadcasting.h"
#include "detection/operators.h"

namespace msf {
namespace {

using Results = StatusOr<std::vector<ResultInfo>>;

Results SameAsFirst(const InferContext& c) {
  return std::vector<ResultInfo>{{c.shape(0), c.inputs[0].type}};
}

Results FloatAsFirst(const InferContext& c) {
  if (c.inputs[0].type != ElementType::kFloat) return Status::Error("needs floating point input");
  return SameAsFirst(c);
}

template <float (*F)(float, const Node&)>
Status Unary(const ComputeContext& c) {
  const InputView& x = c.inputs[0];
  const OutputView& y = c.outputs[0];
  for (size_t i = 0; i < y.floats.size(); ++i) y.floats[i] = F(x.floats[i], c.node);
  return Status::Ok();
}

template <float (*F)(float, const Node&)>
Operator UnaryOperator() {
  return {1, 1, FloatAsFirst, Unary<F>};
}

float Sigmoid(float x, const Node&) { return 1.0f / (1.0f + std::exp(-x)); }
float Silu(float x, const Node&) { return x / (1.0f + std::exp(-x)); }
float Relu(float x, const Node&) { return std::max(x, 0.0f); }
float LeakyRelu(float x, const Node& n) { return x < 0 ? x * n.Float("alpha", 0.01f) : x; }
float Tanh(float x, const Node&) { return std::tanh(x); }
float Exp(float x, const Node&) { return std::exp(x); }
float Log(float x, const Node&) { return std::log(x); }
float Sqrt(float x, const Node&) { return std::sqrt(x); }
float Erf(float x, const Node&) { return std::erf(x); }
float Neg(float x, const Node&) { return -x; }
float Abs(float x, const Node&) { return std::abs(x); }
float Floor(float x, const Node&) { return std::floor(x); }
float Ceil(float x, const Node&) { return std::ceil(x); }
float Softplus(float x, const Node&) { return x > 20 ? x : std::log1p(std::exp(x)); }
float HardSigmoid(float x, const Node& n) {
  return std::clamp(x * n.Float("alpha", 0.2f) + n.Float("beta", 0.5f), 0.0f, 1.0f);
}
float HardSwish(float x, const Node&) { return x * std::clamp(x / 6 + 0.5f, 0.0f, 1.0f); }

Status Copy(const ComputeContext& c) {
  std::copy(c.inputs[0].floats.begin(), c.inputs[0].floats.end(), c.outputs[0].floats.begin());
  std::copy(c.inputs[0].ints.begin(), c.inputs[0].ints.end(), c.outputs[0].ints.begin());
  return Status::Ok();
}

// Two operands of one type; the result has that type, or is an integer for a comparison.
template <bool kComparison>
Results InferBinary(const InferContext& c) {
  if (c.inputs[0].type != c.inputs[1].type) return Status::Error("mixes floats and integers");
  StatusOr<Shape> shape = BroadcastShape(c.shape(0), c.shape(1));
  if (!shape.ok()) return shape.status();
  return std::vector<ResultInfo>{{*shape, kComparison ? ElementType::kInt : c.inputs[0].type}};
}

template <typename F>
Status ComputeBinary(const ComputeContext& c) {
  const InputView& a = c.inputs[0];
  const InputView& b = c.inputs[1];
  const OutputView& y = c.outputs[0];
  const Shape as = BroadcastStrides(a.shape, y.shape);
  const Shape bs = BroadcastStrides(b.shape, y.shape);
  const auto run = [&](auto x, auto z, auto out) {
    ForEachBroadcast(y.shape, as, bs, [&](int64_t i, int64_t j, int64_t k) {
      out[static_cast<size_t>(i)] = F::Of(x[static_cast<size_t>(j)], z[static_cast<size_t>(k)]);
    });
  };
  if (a.type == ElementType::kInt) {
    run(a.ints, b.ints, y.ints);
  } else if (y.type == ElementType::kInt) {
    run(a.floats, b.floats, y.ints);
  } else {
    run(a.floats, b.floats, y.floats);
  }
  return Status::Ok();
}

// Integers wrap around: overflow comes from damaged files only, but must not be undefined.
template <typename F>
int64_t Wrapping(int64_t a, int64_t b, F f) {
  return static_cast<int64_t>(f(static_cast<uint64_t>(a), static_cast<uint64_t>(b)));
}
struct AddOf {
  static float Of(float a, float b) { return a + b; }
  static int64_t Of(int64_t a, int64_t b) { return Wrapping(a, b, std::plus<>()); }
};
struct SubOf {
  static float Of(float a, float b) { return a - b; }
  static int64_t Of(int64_t a, int64_t b) { return Wrapping(a, b, std::minus<>()); }
};
struct MulOf {
  static float Of(float a, float b) { return a * b; }
  static int64_t Of(int64_t a, int64_t b) { return Wrapping(a, b, std::multiplies<>()); }
};
struct DivOf {
  static float Of(float a, float b) { return a / b; }
  static int64_t Of(int64_t a, int64_t b) {
    const bool overflow = a == std::numeric_limits<int64_t>::min() && b == -1;
    return b == 0 || overflow ? 0 : a / b;
  }
};
struct PowOf {
  static float Of(float a, float b) { return std::pow(a, b); }
  static int64_t Of(int64_t a, int64_t b) {
    const double power = std::pow(static_cast<double>(a), static_cast<double>(b));
    return std::abs(power) < 9e18 ? static_cast<int64_t>(power) : 0;
  }
};
template <typename T>
using Plain = std::type_identity_t<T>;
struct MinOf {
  template <typename T>
  static T Of(T a, Plain<T> b) {
    return std::min(a, b);
  }
};
struct MaxOf {
  template <typename T>
  static T Of(T a, Plain<T> b) {
    return std::max(a, b);
  }
};
struct EqualOf {
  template <typename T>
  static int64_t Of(T a, Plain<T> b) {
    return a == b;
  }
};
struct LessOf {
  template <typename T>
  static int64_t Of(T a, Plain<T> b) {
    return a < b;
  }
};
struct GreaterOf {
  template <typename T>
  static int64_t Of(T a, Plain<T> b) {
    return a > b;
  }
};
struct AndOf {
  template <typename T>
  static int64_t Of(T a, Plain<T> b) {
    return a != 0 && b != 0;
  }
};
struct OrOf {
  template <typename T>
  static int64_t Of(T a, Plain<T> b) {
    return a != 0 || b != 0;
  }
};

template <typename F>
Operator BinaryOperator() {
  return {2, 2, InferBinary<false>, ComputeBinary<F>};
}
template <typename F>
Operator Comparison() {
  return {2, 2, InferBinary<true>, ComputeBinary<F>};
}

Results InferWhere(const InferContext& c) {
  if (c.inputs[0].type != ElementType::kInt) return Status::Error("needs a condition of integers");
  if (c.inputs[1].type != c.inputs[2].type) return Status::Error("mixes floats and integers");
  StatusOr<Shape> values = BroadcastShape(c.shape(1), c.shape(2));
  if (!values.ok()) return values.status();
  StatusOr<Shape> shape = BroadcastShape(c.shape(0), *values);
  if (!shape.ok()) return shape.status();
  return std::vector<ResultInfo>{{*shape, c.inputs[1].type}};
}

Status ComputeWhere(const ComputeContext& c) {
  const OutputView& y = c.outputs[0];
  const Shape conditions = BroadcastStrides(c.inputs[0].shape, y.shape);
  for (const bool wanted : {true, false}) {
    const InputView& x = c.inputs[wanted ? 1 : 2];
    const Shape strides = BroadcastStrides(x.shape, y.shape);
    ForEachBroadcast(y.shape, conditions, strides, [&](int64_t i, int64_t j, int64_t k) {
      if ((c.inputs[0].ints[static_cast<size_t>(j)] != 0) != wanted) return;
      const size_t to = static_cast<size_t>(i), from = static_cast<size_t>(k);
      if (y.type == ElementType::kInt) {
        y.ints[to] = x.ints[from];
      } else {
        y.floats[to] = x.floats[from];
      }
    });
  }
  return Status::Ok();
}

// Bounds are attributes up to opset 10, inputs later.
Status ComputeClip(const ComputeContext& c) {
  const auto bound = [&](size_t i, const char* key, float otherwise) {
    if (c.Has(i)) return c.inputs[i].floats.empty() ? otherwise : c.inputs[i].floats[0];
    return c.node.Float(key, otherwise);
  };
  constexpr float kLimit = std::numeric_limits<float>::max();
  const float low = bound(1, "min", -kLimit);
  const float high = bound(2, "max", kLimit);
  for (size_t i = 0; i < c.outputs[0].floats.size(); ++i) {
    c.outputs[0].floats[i] = std::min(std::max(c.inputs[0].floats[i], low), high);
  }
  return Status::Ok();
}

// ONNX element types: 1 float, 10 half, 11 double, 16 bfloat16; everything else we hold as
// integers.
Results InferCast(const InferContext& c) {
  const int64_t to = c.node.Int("to", 0);
  if (to == 8 || to == 14 || to == 15) return Status::Error("casts to text or complex numbers");
  const bool floats = to == 1 || to == 10 || to == 11 || to == 16;
  return std::vector<ResultInfo>{{c.shape(0), floats ? ElementType::kFloat : ElementType::kInt}};
}

int64_t ToInt(float x) {
  if (!(std::abs(x) < 9e18f)) return 0;
  return static_cast<int64_t>(x);
}

Status ComputeCast(const ComputeContext& c) {
  const InputView& x = c.inputs[0];
  const OutputView& y = c.outputs[0];
  if (x.type == y.type) return Copy(c);
  const bool to_bool = c.node.Int("to", 0) == 9;
  for (size_t i = 0; i < y.ints.size(); ++i) {
    y.ints[i] = to_bool ? x.floats[i] != 0 : ToInt(x.floats[i]);
  }
  for (size_t i = 0; i < y.floats.size(); ++i) y.floats[i] = static_cast<float>(x.ints[i]);
  return Status::Ok();
}

}  // namespace

std::vector<NamedOperator> ElementwiseOperators() {
  return {
      {"Sigmoid", UnaryOperator<Sigmoid>()},
      {"Silu", UnaryOperator<Silu>()},
      {"Relu", UnaryOperator<Relu>()},
      {"LeakyRelu", UnaryOperator<LeakyRelu>()},
      {"Tanh", UnaryOperator<Tanh>()},
      {"Exp", UnaryOperator<Exp>()},
      {"Log", UnaryOperator<Log>()},
      {"Sqrt", UnaryOperator<Sqrt>()},
      {"Erf", UnaryOperator<Erf>()},
      {"Neg", UnaryOperator<Neg>()},
      {"Abs", UnaryOperator<Abs>()},
      {"Floor", UnaryOperator<Floor>()},
      {"Ceil", UnaryOperator<Ceil>()},
      {"Softplus", UnaryOperator<Softplus>()},
      {"HardSigmoid", UnaryOperator<HardSigmoid>()},
      {"HardSwish", UnaryOperator<HardSwish>()},
      {"Identity", {1, 1, SameAsFirst, Copy}},
      {"Dropout", {1, 3, SameAsFirst, Copy}},
      {"Add", BinaryOperator<AddOf>()},
      {"Sub", BinaryOperator<SubOf>()},
      {"Mul", BinaryOperator<MulOf>()},
      {"Div", BinaryOperator<DivOf>()},
      {"Pow", BinaryOperator<PowOf>()},
      {"Min", BinaryOperator<MinOf>()},
      {"Max", BinaryOperator<MaxOf>()},
      {"Equal", Comparison<EqualOf>()},
      {"Less", Comparison<LessOf>()},
      {"Greater", Comparison<GreaterOf>()},
      {"And", Comparison<AndOf>()},
      {"Or", Comparison<OrOf>()},
      {"Where", {3, 3, InferWhere, ComputeWhere}},
      {"Clip", {1, 3, FloatAsFirst, ComputeClip}},
      {"Cast", {1, 1, InferCast, ComputeCast}},
  };
}

}  // namespace msf
