// Matrix products, softmax and reductions.
#include <algorithm>
#include <cmath>
#include <limits>

#include "detection/broadcasting.h"
#include "detection/operators.h"

namespace msf {
namespace {

using Results = StatusOr<std::vector<ResultInfo>>;

Shape Batch(const Shape& x) { return Shape(x.begin(), x.end() - 2); }

Results InferMatMul(const InferContext& c) {
  const Shape& a = c.shape(0);
  const Shape& b = c.shape(1);
  if (c.inputs[0].type != ElementType::kFloat || c.inputs[1].type != ElementType::kFloat) {
    return Status::Error("needs floating point operands");
  }
  if (a.size() < 2 || b.size() < 2 || a.back() != b[b.size() - 2]) {
    return Status::Error("cannot multiply " + ToString(a) + " with " + ToString(b));
  }
  StatusOr<Shape> shape = BroadcastShape(Batch(a), Batch(b));
  if (!shape.ok()) return shape.status();
  shape->push_back(a[a.size() - 2]);
  shape->push_back(b.back());
  return std::vector<ResultInfo>{{*shape, ElementType::kFloat}};
}

// y[m x n] = a[m x k] * b[k x n]; the inner loop runs over contiguous columns.
void Multiply(const float* a, const float* b, float* y, size_t m, size_t k, size_t n) {
  std::fill(y, y + m * n, 0.0f);
  for (size_t i = 0; i < m; ++i) {
    for (size_t j = 0; j < k; ++j) {
      const float factor = a[i * k + j];
      for (size_t l = 0; l < n; ++l) y[i * n + l] += factor * b[j * n + l];
    }
  }
}

Status ComputeMatMul(const ComputeContext& c) {
  const InputView& a = c.inputs[0];
  const InputView& b = c.inputs[1];
  const OutputView& y = c.outputs[0];
  const size_t m = static_cast<size_t>(y.shape[y.shape.size() - 2]);
  const size_t n = static_cast<size_t>(y.shape.back());
  const size_t k = static_cast<size_t>(a.shape.back());
  const Shape batch = Batch(y.shape);
  ForEachBroadcast(batch, BroadcastStrides(Batch(a.shape), batch),
                   BroadcastStrides(Batch(b.shape), batch), [&](int64_t i, int64_t j, int64_t l) {
                     Multiply(a.floats.data() + static_cast<size_t>(j) * m * k,
                              b.floats.data() + static_cast<size_t>(l) * k * n,
                              y.floats.data() + static_cast<size_t>(i) * m * n, m, k, n);
                   });
  return Status::Ok();
}

int64_t SoftmaxAxis(const Node& node, int64_t opset) {
  return node.Int("axis", opset < 13 ? 1 : -1);
}

Results InferSoftmax(const InferContext& c) {
  if (c.inputs[0].type != ElementType::kFloat) return Status::Error("needs floating point input");
  StatusOr<int64_t> axis = NormalizeAxis(SoftmaxAxis(c.node, c.opset), c.shape(0).size());
  if (!axis.ok()) return axis.status();
  // Up to opset 12 everything behind the axis was normalised together.
  if (c.opset < 13 && *axis + 1 != static_cast<int64_t>(c.shape(0).size())) {
    return Status::Error("of opset 12 and before is supported along the last dimension only");
  }
  return std::vector<ResultInfo>{{c.shape(0), ElementType::kFloat}};
}

Status ComputeSoftmax(const ComputeContext& c) {
  const Shape& shape = c.inputs[0].shape;
  if (NumElements(shape) == 0) return Status::Ok();
  const size_t axis =
      static_cast<size_t>(*NormalizeAxis(SoftmaxAxis(c.node, c.opset), shape.size()));
  const size_t inner = static_cast<size_t>(DenseStrides(shape)[axis]);
  const size_t count = static_cast<size_t>(shape[axis]);
  const size_t block = inner * count;
  std::vector<float> highest(inner), sum(inner);
  for (size_t at = 0; at < c.inputs[0].floats.size(); at += block) {
    const float* x = c.inputs[0].floats.data() + at;
    float* y = c.outputs[0].floats.data() + at;
    std::copy(x, x + inner, highest.begin());
    std::fill(sum.begin(), sum.end(), 0.0f);
    for (size_t i = 0; i < block; ++i) highest[i % inner] = std::max(highest[i % inner], x[i]);
    for (size_t k = 0; k < count; ++k) {
      for (size_t i = 0; i < inner; ++i) {
        y[k * inner + i] = std::exp(x[k * inner + i] - highest[i]);
        sum[i] += y[k * inner + i];
      }
    }
    for (size_t k = 0; k < count; ++k) {
      for (size_t i = 0; i < inner; ++i) y[k * inner + i] /= sum[i];
    }
  }
  return Status::Ok();
}

StatusOr<std::vector<bool>> ReducedAxes(const Node& node, size_t rank,
                                        const std::vector<int64_t>& axes) {
  std::vector<bool> reduced(rank, axes.empty() && node.Int("noop_with_empty_axes", 0) == 0);
  for (const int64_t axis : axes) {
    StatusOr<int64_t> normal = NormalizeAxis(axis, rank);
    if (!normal.ok()) return normal.status();
    reduced[static_cast<size_t>(*normal)] = true;
  }
  return reduced;
}

Results InferReduce(const InferContext& c) {
  std::vector<int64_t> axes = c.node.Ints("axes");
  if (c.Has(1)) {
    StatusOr<std::vector<int64_t>> input = c.ConstantInts(1);
    if (!input.ok()) return input.status();
    axes = *input;
  }
  if (c.inputs[0].type != ElementType::kFloat) return Status::Error("needs floating point input");
  StatusOr<std::vector<bool>> reduced = ReducedAxes(c.node, c.shape(0).size(), axes);
  if (!reduced.ok()) return reduced.status();
  Shape shape;
  for (size_t i = 0; i < c.shape(0).size(); ++i) {
    if (!(*reduced)[i]) shape.push_back(c.shape(0)[i]);
    if ((*reduced)[i] && c.node.Int("keepdims", 1) != 0) shape.push_back(1);
  }
  return std::vector<ResultInfo>{{shape, ElementType::kFloat}};
}

enum class Reduction { kMean, kSum, kMax };

template <Reduction kKind>
Status ComputeReduce(const ComputeContext& c) {
  const InputView& x = c.inputs[0];
  const OutputView& y = c.outputs[0];
  std::vector<int64_t> axes = c.node.Ints("axes");
  if (c.Has(1)) axes.assign(c.inputs[1].ints.begin(), c.inputs[1].ints.end());
  StatusOr<std::vector<bool>> reduced = ReducedAxes(c.node, x.shape.size(), axes);
  if (!reduced.ok()) return reduced.status();
  Shape kept = x.shape;
  for (size_t i = 0; i < kept.size(); ++i) {
    if ((*reduced)[i]) kept[i] = 1;
  }
  const float start = kKind == Reduction::kMax ? -std::numeric_limits<float>::infinity() : 0;
  std::fill(y.floats.begin(), y.floats.end(), start);
  const Shape to = BroadcastStrides(kept, x.shape);
  ForEachBroadcast(x.shape, to, to, [&](int64_t i, int64_t j, int64_t) {
    float& target = y.floats[static_cast<size_t>(j)];
    const float value = x.floats[static_cast<size_t>(i)];
    target = kKind == Reduction::kMax ? std::max(target, value) : target + value;
  });
  if (kKind == Reduction::kMean && !y.floats.empty()) {
    const float count = static_cast<float>(x.floats.size()) / static_cast<float>(y.floats.size());
    for (float& value : y.floats) value /= count;
  }
  return Status::Ok();
}

}  // namespace

std::vector<NamedOperator> MatrixOperators() {
  return {
      {"MatMul", {2, 2, InferMatMul, ComputeMatMul}},
      {"Softmax", {1, 1, InferSoftmax, ComputeSoftmax}},
      {"ReduceMean", {1, 2, InferReduce, ComputeReduce<Reduction::kMean>}},
      {"ReduceSum", {1, 2, InferReduce, ComputeReduce<Reduction::kSum>}},
      {"ReduceMax", {1, 2, InferReduce, ComputeReduce<Reduction::kMax>}},
  };
}

}  // namespace msf
