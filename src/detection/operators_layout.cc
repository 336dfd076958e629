// Operators that move elements without changing them.
#include <algorithm>
#include <limits>
#include <numeric>

#include "detection/broadcasting.h"
#include "detection/operators.h"

namespace msf {
namespace {

using Results = StatusOr<std::vector<ResultInfo>>;

Results One(Shape shape, ElementType type) {
  return std::vector<ResultInfo>{{std::move(shape), type}};
}

Status CopyAll(const ComputeContext& c) {
  std::copy(c.inputs[0].floats.begin(), c.inputs[0].floats.end(), c.outputs[0].floats.begin());
  std::copy(c.inputs[0].ints.begin(), c.inputs[0].ints.end(), c.outputs[0].ints.begin());
  return Status::Ok();
}

// Copies elements at from_offset + strides of a box of `shape` into a box of the output.
void CopyBox(const InputView& x, int64_t from, const Shape& from_strides, const OutputView& y,
             int64_t to, const Shape& to_strides, const Shape& shape) {
  ForEachBroadcast(shape, from_strides, to_strides, [&](int64_t, int64_t a, int64_t b) {
    const size_t source = static_cast<size_t>(from + a), target = static_cast<size_t>(to + b);
    if (y.type == ElementType::kInt) {
      y.ints[target] = x.ints[source];
    } else {
      y.floats[target] = x.floats[source];
    }
  });
}

Results InferReshape(const InferContext& c) {
  StatusOr<std::vector<int64_t>> wanted = c.ConstantInts(1);
  if (!wanted.ok()) return wanted.status();
  const int64_t count = NumElements(c.shape(0));
  Shape shape = *wanted;
  int64_t known = 1;
  int64_t* open = nullptr;
  for (size_t i = 0; i < shape.size(); ++i) {
    if (shape[i] == 0 && c.node.Int("allowzero", 0) == 0) {
      if (i >= c.shape(0).size()) return Status::Error("keeps a dimension that is not there");
      shape[i] = c.shape(0)[i];
    }
    if (shape[i] == -1) {
      if (open) return Status::Error("leaves two dimensions open");
      open = &shape[i];
    } else {
      if (shape[i] < 0 || shape[i] > kMaxElements) return Status::Error("has a bad target shape");
      known *= shape[i];
      if (known > kMaxElements) return Status::Error("has a bad target shape");
    }
  }
  if (open) *open = known == 0 ? 0 : count / known;
  if ((open ? known * *open : known) != count) {
    return Status::Error("cannot turn " + ToString(c.shape(0)) + " into " + ToString(*wanted));
  }
  return One(shape, c.inputs[0].type);
}

Results InferFlatten(const InferContext& c) {
  const Shape& x = c.shape(0);
  const int64_t rank = static_cast<int64_t>(x.size());
  int64_t axis = c.node.Int("axis", 1);
  if (axis < 0) axis += rank;
  if (axis < 0 || axis > rank) return Status::Error("has a bad axis");
  const Shape front(x.begin(), x.begin() + axis);
  const Shape back(x.begin() + axis, x.end());
  return One({NumElements(front), NumElements(back)}, c.inputs[0].type);
}

// Axes of Squeeze and Unsqueeze: an input since opset 13, an attribute before.
StatusOr<std::vector<int64_t>> Axes(const InferContext& c, size_t rank) {
  std::vector<int64_t> axes = c.node.Ints("axes");
  if (c.Has(1)) {
    StatusOr<std::vector<int64_t>> input = c.ConstantInts(1);
    if (!input.ok()) return input.status();
    axes = *input;
  }
  for (int64_t& axis : axes) {
    StatusOr<int64_t> normal = NormalizeAxis(axis, rank);
    if (!normal.ok()) return normal.status();
    axis = *normal;
  }
  std::sort(axes.begin(), axes.end());
  if (std::adjacent_find(axes.begin(), axes.end()) != axes.end()) {
    return Status::Error("names an axis twice");
  }
  return axes;
}

Results InferSqueeze(const InferContext& c) {
  const Shape& x = c.shape(0);
  StatusOr<std::vector<int64_t>> axes = Axes(c, x.size());
  if (!axes.ok()) return axes.status();
  Shape shape;
  for (size_t i = 0; i < x.size(); ++i) {
    const bool named = std::count(axes->begin(), axes->end(), static_cast<int64_t>(i)) > 0;
    if (named && x[i] != 1) return Status::Error("squeezes a dimension of " + ToString(x));
    if (!(named || (axes->empty() && x[i] == 1))) shape.push_back(x[i]);
  }
  return One(shape, c.inputs[0].type);
}

Results InferUnsqueeze(const InferContext& c) {
  const size_t added =
      c.Has(1) ? static_cast<size_t>(NumElements(c.shape(1))) : c.node.Ints("axes").size();
  if (added > 8) return Status::Error("adds too many dimensions");
  StatusOr<std::vector<int64_t>> axes = Axes(c, c.shape(0).size() + added);
  if (!axes.ok()) return axes.status();
  Shape shape = c.shape(0);
  for (const int64_t axis : *axes) shape.insert(shape.begin() + axis, 1);
  return One(shape, c.inputs[0].type);
}

std::vector<int64_t> Permutation(const Node& node, size_t rank) {
  std::vector<int64_t> reversed(rank);
  std::iota(reversed.rbegin(), reversed.rend(), 0);
  return node.Ints("perm", reversed);
}

Results InferTranspose(const InferContext& c) {
  const Shape& x = c.shape(0);
  const std::vector<int64_t> perm = Permutation(c.node, x.size());
  if (perm.size() != x.size()) return Status::Error("permutes another number of dimensions");
  Shape shape;
  std::vector<bool> seen(x.size(), false);
  for (const int64_t axis : perm) {
    if (axis < 0 || axis >= static_cast<int64_t>(x.size()) || seen[static_cast<size_t>(axis)]) {
      return Status::Error("has a bad permutation");
    }
    seen[static_cast<size_t>(axis)] = true;
    shape.push_back(x[static_cast<size_t>(axis)]);
  }
  return One(shape, c.inputs[0].type);
}

Status ComputeTranspose(const ComputeContext& c) {
  const OutputView& y = c.outputs[0];
  const Shape dense = DenseStrides(c.inputs[0].shape);
  Shape strides;
  for (const int64_t axis : Permutation(c.node, dense.size())) {
    strides.push_back(dense[static_cast<size_t>(axis)]);
  }
  CopyBox(c.inputs[0], 0, strides, y, 0, DenseStrides(y.shape), y.shape);
  return Status::Ok();
}

Results InferConcat(const InferContext& c) {
  Shape shape = c.shape(0);
  StatusOr<int64_t> axis = NormalizeAxis(c.node.Int("axis", 1), shape.size());
  if (!axis.ok()) return axis.status();
  for (size_t i = 1; i < c.inputs.size(); ++i) {
    if (!c.Has(i)) return Status::Error("lacks an input");
    Shape other = c.shape(i);
    if (other.size() != shape.size() || c.inputs[i].type != c.inputs[0].type) {
      return Status::Error("joins " + ToString(shape) + " and " + ToString(other));
    }
    const size_t at = static_cast<size_t>(*axis);
    const int64_t size = other[at];
    other[at] = shape[at];
    if (other != shape)
      return Status::Error("joins " + ToString(shape) + " and " + ToString(c.shape(i)));
    shape[at] += size;
  }
  return One(shape, c.inputs[0].type);
}

Status ComputeConcat(const ComputeContext& c) {
  const OutputView& y = c.outputs[0];
  const size_t axis = static_cast<size_t>(*NormalizeAxis(c.node.Int("axis", 1), y.shape.size()));
  const Shape strides = DenseStrides(y.shape);
  int64_t at = 0;
  for (const InputView& x : c.inputs) {
    CopyBox(x, 0, DenseStrides(x.shape), y, at * strides[axis], strides, x.shape);
    at += x.shape[axis];
  }
  return Status::Ok();
}

// Sizes of the pieces: attribute up to opset 12, input later, otherwise equal parts.
Results InferSplit(const InferContext& c) {
  const Shape& x = c.shape(0);
  StatusOr<int64_t> axis = NormalizeAxis(c.node.Int("axis", 0), x.size());
  if (!axis.ok()) return axis.status();
  const int64_t size = x[static_cast<size_t>(*axis)];
  std::vector<int64_t> sizes = c.node.Ints("split");
  if (c.Has(1)) {
    StatusOr<std::vector<int64_t>> input = c.ConstantInts(1);
    if (!input.ok()) return input.status();
    sizes = *input;
  }
  const int64_t parts = static_cast<int64_t>(c.node.outputs.size());
  if (sizes.empty()) {
    const int64_t part = (size + parts - 1) / parts;
    for (int64_t i = 0; i < parts; ++i)
      sizes.push_back(std::clamp<int64_t>(size - i * part, 0, part));
  }
  int64_t sum = 0;
  std::vector<ResultInfo> results;
  for (const int64_t part : sizes) {
    if (part < 0 || part > size) return Status::Error("has a bad split");
    sum += part;
    Shape shape = x;
    shape[static_cast<size_t>(*axis)] = part;
    results.push_back({shape, c.inputs[0].type});
  }
  if (sum != size) return Status::Error("does not split " + ToString(x) + " completely");
  return results;
}

Status ComputeSplit(const ComputeContext& c) {
  const InputView& x = c.inputs[0];
  const size_t axis = static_cast<size_t>(*NormalizeAxis(c.node.Int("axis", 0), x.shape.size()));
  const Shape strides = DenseStrides(x.shape);
  int64_t at = 0;
  for (const OutputView& y : c.outputs) {
    CopyBox(x, at * strides[axis], strides, y, 0, DenseStrides(y.shape), y.shape);
    at += y.shape[axis];
  }
  return Status::Ok();
}

// Ours: `count` channels from `first` on, what Split and Slice become along the channels.
Results InferSliceChannels(const InferContext& c) {
  Shape shape = c.shape(0);
  const int64_t first = c.node.Int("first", 0), count = c.node.Int("count", 0);
  if (shape.size() != 4 || first < 0 || count < 0 || first + count > shape[1]) {
    return Status::Error("cuts channels that are not there");
  }
  shape[1] = count;
  return One(shape, c.inputs[0].type);
}

Status ComputeSliceChannels(const ComputeContext& c) {
  const OutputView& y = c.outputs[0];
  const Shape strides = DenseStrides(c.inputs[0].shape);
  CopyBox(c.inputs[0], c.node.Int("first", 0) * strides[1], strides, y, 0, DenseStrides(y.shape),
          y.shape);
  return Status::Ok();
}

Results InferExpand(const InferContext& c) {
  StatusOr<std::vector<int64_t>> wanted = c.ConstantInts(1);
  if (!wanted.ok()) return wanted.status();
  for (const int64_t size : *wanted) {
    if (size < 0) return Status::Error("has a bad target shape");
  }
  StatusOr<Shape> shape = BroadcastShape(c.shape(0), *wanted);
  if (!shape.ok()) return shape.status();
  return One(*shape, c.inputs[0].type);
}

Status ComputeExpand(const ComputeContext& c) {
  const OutputView& y = c.outputs[0];
  CopyBox(c.inputs[0], 0, BroadcastStrides(c.inputs[0].shape, y.shape), y, 0, DenseStrides(y.shape),
          y.shape);
  return Status::Ok();
}

}  // namespace

std::vector<NamedOperator> LayoutOperators() {
  constexpr int kMany = 4096;
  return {
      {"Reshape", {2, 2, InferReshape, CopyAll}},
      {"Flatten", {1, 1, InferFlatten, CopyAll}},
      {"Squeeze", {1, 2, InferSqueeze, CopyAll}},
      {"Unsqueeze", {1, 2, InferUnsqueeze, CopyAll}},
      {"Transpose", {1, 1, InferTranspose, ComputeTranspose}},
      {"Concat", {1, kMany, InferConcat, ComputeConcat}},
      {"Split", {1, 2, InferSplit, ComputeSplit}},
      {"SliceChannels", {1, 1, InferSliceChannels, ComputeSliceChannels}},
      {"Expand", {2, 2, InferExpand, ComputeExpand}},
  };
}

}  // namespace msf
