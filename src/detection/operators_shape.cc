// Operators that compute shapes and indices: exporters with symbolic sizes leave them in the graph,
// a fixed size folds them away.
#include <algorithm>
#include <cmath>
#include <limits>

#include "detection/broadcasting.h"
#include "detection/operators.h"

namespace msf {
namespace {

using Results = StatusOr<std::vector<ResultInfo>>;

Results One(Shape shape, ElementType type) {
  return std::vector<ResultInfo>{{std::move(shape), type}};
}

Results InferShape(const InferContext& c) {
  if (c.node.Has("start") || c.node.Has("end")) return Status::Error("of a part is not supported");
  return One({static_cast<int64_t>(c.shape(0).size())}, ElementType::kInt);
}

Status ComputeShape(const ComputeContext& c) {
  std::copy(c.inputs[0].shape.begin(), c.inputs[0].shape.end(), c.outputs[0].ints.begin());
  return Status::Ok();
}

Results InferGather(const InferContext& c) {
  const Shape& x = c.shape(0);
  StatusOr<int64_t> axis = NormalizeAxis(c.node.Int("axis", 0), x.size());
  if (!axis.ok()) return axis.status();
  if (c.inputs[1].type != ElementType::kInt) return Status::Error("needs indices of integers");
  Shape shape(x.begin(), x.begin() + *axis);
  shape.insert(shape.end(), c.shape(1).begin(), c.shape(1).end());
  shape.insert(shape.end(), x.begin() + *axis + 1, x.end());
  return One(shape, c.inputs[0].type);
}

Status ComputeGather(const ComputeContext& c) {
  const InputView& x = c.inputs[0];
  const OutputView& y = c.outputs[0];
  const size_t axis = static_cast<size_t>(*NormalizeAxis(c.node.Int("axis", 0), x.shape.size()));
  const int64_t size = x.shape[axis];
  const Shape strides = DenseStrides(x.shape);
  const int64_t inner = strides[axis];
  const int64_t outer =
      NumElements(Shape(x.shape.begin(), x.shape.begin() + static_cast<int64_t>(axis)));
  size_t to = 0;
  for (int64_t o = 0; o < outer; ++o) {
    for (int64_t index : c.inputs[1].ints) {
      if (index < 0) index += size;
      if (index < 0 || index >= size) return Status::Error("gathers outside of its input");
      const size_t from = static_cast<size_t>((o * size + index) * inner);
      for (size_t i = 0; i < static_cast<size_t>(inner); ++i, ++to) {
        if (y.type == ElementType::kInt) {
          y.ints[to] = x.ints[from + i];
        } else {
          y.floats[to] = x.floats[from + i];
        }
      }
    }
  }
  return Status::Ok();
}

// Start, step and count per dimension.
struct SliceRange {
  int64_t start = 0;
  int64_t step = 1;
  int64_t count = 0;
};

StatusOr<SliceRange> MakeRange(int64_t size, int64_t start, int64_t end, int64_t step) {
  if (step == 0 || step == std::numeric_limits<int64_t>::min()) {
    return Status::Error("has a bad step");
  }
  const auto clamp = [&](int64_t x, int64_t low, int64_t high) {
    return std::clamp(x < 0 ? x + size : x, low, high);
  };
  SliceRange range;
  range.step = step;
  if (step > 0) {
    range.start = clamp(start, 0, size);
    const int64_t length = clamp(end, 0, size) - range.start;
    range.count = length > 0 ? (length - 1) / step + 1 : 0;
  } else {
    range.start = clamp(start, -1, size - 1);
    const int64_t length = range.start - clamp(end, -1, size - 1);
    range.count = length > 0 ? (length - 1) / -step + 1 : 0;
  }
  return range;
}

struct SliceBounds {
  std::vector<int64_t> starts, ends, axes, steps;
};

// Inputs since opset 10, attributes before. `ints(i)` reads input i.
template <typename Ints>
StatusOr<SliceBounds> ReadBounds(const Node& node, size_t num_inputs, const Ints& ints) {
  SliceBounds b{node.Ints("starts"), node.Ints("ends"), node.Ints("axes"), {}};
  std::vector<int64_t>* targets[] = {&b.starts, &b.ends, &b.axes, &b.steps};
  for (size_t i = 1; i < num_inputs; ++i) {
    StatusOr<std::vector<int64_t>> values = ints(i);
    if (!values.ok()) return values.status();
    *targets[i - 1] = *values;
  }
  const size_t n = b.starts.size();
  if (n > 16) return Status::Error("has too many axes");
  if (b.axes.empty()) {
    for (size_t i = 0; i < n; ++i) b.axes.push_back(static_cast<int64_t>(i));
  }
  if (b.steps.empty()) b.steps.assign(n, 1);
  if (b.ends.size() != n || b.axes.size() != n || b.steps.size() != n) {
    return Status::Error("has starts, ends, axes and steps of different lengths");
  }
  return b;
}

StatusOr<std::vector<SliceRange>> Ranges(const Shape& x, const SliceBounds& bounds) {
  std::vector<SliceRange> ranges;
  for (const int64_t size : x) ranges.push_back({0, 1, size});
  for (size_t i = 0; i < bounds.starts.size(); ++i) {
    StatusOr<int64_t> axis = NormalizeAxis(bounds.axes[i], x.size());
    if (!axis.ok()) return axis.status();
    const size_t at = static_cast<size_t>(*axis);
    StatusOr<SliceRange> range =
        MakeRange(x[at], bounds.starts[i], bounds.ends[i], bounds.steps[i]);
    if (!range.ok()) return range.status();
    ranges[at] = *range;
  }
  return ranges;
}

Results InferSlice(const InferContext& c) {
  StatusOr<SliceBounds> bounds =
      ReadBounds(c.node, c.inputs.size(), [&](size_t i) -> StatusOr<std::vector<int64_t>> {
        if (!c.Has(i)) return std::vector<int64_t>();
        return c.ConstantInts(i);
      });
  if (!bounds.ok()) return bounds.status();
  StatusOr<std::vector<SliceRange>> ranges = Ranges(c.shape(0), *bounds);
  if (!ranges.ok()) return ranges.status();
  Shape shape;
  for (const SliceRange& range : *ranges) shape.push_back(range.count);
  return One(shape, c.inputs[0].type);
}

Status ComputeSlice(const ComputeContext& c) {
  const InputView& x = c.inputs[0];
  const OutputView& y = c.outputs[0];
  StatusOr<SliceBounds> bounds =
      ReadBounds(c.node, c.inputs.size(), [&](size_t i) -> StatusOr<std::vector<int64_t>> {
        return std::vector<int64_t>(c.inputs[i].ints.begin(), c.inputs[i].ints.end());
      });
  if (!bounds.ok()) return bounds.status();
  StatusOr<std::vector<SliceRange>> ranges = Ranges(x.shape, *bounds);
  if (!ranges.ok()) return ranges.status();
  const Shape dense = DenseStrides(x.shape);
  Shape strides;
  int64_t offset = 0;
  for (size_t d = 0; d < dense.size(); ++d) {
    strides.push_back(dense[d] * (*ranges)[d].step);
    offset += dense[d] * (*ranges)[d].start;
  }
  ForEachBroadcast(y.shape, strides, strides, [&](int64_t to, int64_t from, int64_t) {
    if (y.type == ElementType::kInt) {
      y.ints[static_cast<size_t>(to)] = x.ints[static_cast<size_t>(offset + from)];
    } else {
      y.floats[static_cast<size_t>(to)] = x.floats[static_cast<size_t>(offset + from)];
    }
  });
  return Status::Ok();
}

const Tensor* FillValue(const Node& node) {
  const auto found = node.attributes.find("value");
  return found == node.attributes.end() ? nullptr : std::get_if<Tensor>(&found->second);
}

Results InferConstantOfShape(const InferContext& c) {
  StatusOr<std::vector<int64_t>> shape = c.ConstantInts(0);
  if (!shape.ok()) return shape.status();
  const Tensor* value = FillValue(c.node);
  if (value && value->size() != 1) return Status::Error("needs one value to fill with");
  return One(*shape, value ? value->type : ElementType::kFloat);
}

Status ComputeConstantOfShape(const ComputeContext& c) {
  const Tensor* value = FillValue(c.node);
  const OutputView& y = c.outputs[0];
  std::fill(y.floats.begin(), y.floats.end(),
            value && !value->floats.empty() ? value->floats[0] : 0);
  std::fill(y.ints.begin(), y.ints.end(), value && !value->ints.empty() ? value->ints[0] : 0);
  return Status::Ok();
}

double Scalar(const Tensor& tensor) {
  return tensor.type == ElementType::kInt ? static_cast<double>(tensor.ints[0]) : tensor.floats[0];
}

Results InferRange(const InferContext& c) {
  double bounds[3];
  for (size_t i = 0; i < 3; ++i) {
    if (!c.inputs[i].constant || c.inputs[i].constant->size() != 1) {
      return Status::Error("needs three constant numbers");
    }
    if (c.inputs[i].type != c.inputs[0].type) return Status::Error("mixes floats and integers");
    bounds[i] = Scalar(*c.inputs[i].constant);
  }
  const double count = std::ceil((bounds[1] - bounds[0]) / bounds[2]);
  if (!(count < static_cast<double>(kMaxElements))) return Status::Error("has a bad range");
  return One({static_cast<int64_t>(std::max(count, 0.0))}, c.inputs[0].type);
}

Status ComputeRange(const ComputeContext& c) {
  const OutputView& y = c.outputs[0];
  for (size_t i = 0; i < y.floats.size(); ++i) {
    y.floats[i] = c.inputs[0].floats[0] + static_cast<float>(i) * c.inputs[2].floats[0];
  }
  for (size_t i = 0; i < y.ints.size(); ++i) {
    const uint64_t step = static_cast<uint64_t>(c.inputs[2].ints[0]);
    y.ints[i] = static_cast<int64_t>(static_cast<uint64_t>(c.inputs[0].ints[0]) + i * step);
  }
  return Status::Ok();
}

}  // namespace

std::vector<NamedOperator> ShapeOperators() {
  return {
      {"Shape", {1, 1, InferShape, ComputeShape}},
      {"Gather", {2, 2, InferGather, ComputeGather}},
      {"Slice", {1, 5, InferSlice, ComputeSlice}},
      {"ConstantOfShape", {1, 1, InferConstantOfShape, ComputeConstantOfShape}},
      {"Range", {3, 3, InferRange, ComputeRange}},
  };
}

}  // namespace msf
