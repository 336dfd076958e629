#include "detection/tensor.h"

#include "util/check.h"

namespace msf {

int64_t NumElements(const Shape& shape) {
  int64_t count = 1;
  for (const int64_t size : shape) {
    MSF_CHECK(size >= 0, "the size of " + ToString(shape) + " is not known");
    count *= size;
  }
  return count;
}

std::string ToString(const Shape& shape) {
  if (shape.empty()) return "scalar";
  std::string text;
  for (const int64_t size : shape) {
    if (!text.empty()) text += "x";
    text += size < 0 ? "?" : std::to_string(size);
  }
  return text;
}

Shape DenseStrides(const Shape& shape) {
  Shape strides(shape.size(), 1);
  for (size_t i = shape.size(); i-- > 1;) strides[i - 1] = strides[i] * shape[i];
  return strides;
}

Tensor Tensor::Zeros(ElementType type, const Shape& shape) {
  Tensor tensor;
  tensor.shape = shape;
  tensor.type = type;
  const size_t count = static_cast<size_t>(NumElements(shape));
  if (type == ElementType::kFloat) {
    tensor.floats.resize(count);
  } else {
    tensor.ints.resize(count);
  }
  return tensor;
}

Tensor Tensor::Floats(Shape shape, std::vector<float> values) {
  MSF_CHECK(NumElements(shape) == static_cast<int64_t>(values.size()), "shape and values differ");
  Tensor tensor;
  tensor.shape = std::move(shape);
  tensor.floats = std::move(values);
  return tensor;
}

Tensor Tensor::Ints(Shape shape, std::vector<int64_t> values) {
  MSF_CHECK(NumElements(shape) == static_cast<int64_t>(values.size()), "shape and values differ");
  Tensor tensor;
  tensor.shape = std::move(shape);
  tensor.type = ElementType::kInt;
  tensor.ints = std::move(values);
  return tensor;
}

}  // namespace msf
