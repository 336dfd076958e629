// Small dense tensors of the network reader: constants, shapes and the reference operators work on
// them.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace msf {

// Sizes, outermost first; a scalar has none. -1 stands for a size that is known only at run time.
using Shape = std::vector<int64_t>;

// Everything that is not a floating point number is held as int64 (bool as 0 or 1).
enum class ElementType { kFloat, kInt };

// Elements of a shape whose sizes are all known and not negative.
int64_t NumElements(const Shape& shape);

// "1x3x320x416", "scalar" for no dimension, "?" for an unknown size.
std::string ToString(const Shape& shape);

// Strides in elements of a dense row-major tensor.
Shape DenseStrides(const Shape& shape);

// A dense row-major tensor; the vector of its type is filled, the other one empty.
struct Tensor {
  Shape shape;
  ElementType type = ElementType::kFloat;
  std::vector<float> floats;
  std::vector<int64_t> ints;

  static Tensor Zeros(ElementType type, const Shape& shape);
  static Tensor Floats(Shape shape, std::vector<float> values);
  static Tensor Ints(Shape shape, std::vector<int64_t> values);
  int64_t size() const { return NumElements(shape); }
};

// A tensor somebody else owns, to read from. Not present: an optional operand that was left out.
struct InputView {
  InputView() = default;
  explicit InputView(const Tensor& tensor)
      : present(true),
        shape(tensor.shape),
        type(tensor.type),
        floats(tensor.floats),
        ints(tensor.ints) {}

  bool present = false;
  Shape shape;
  ElementType type = ElementType::kFloat;
  std::span<const float> floats;
  std::span<const int64_t> ints;
};

// A tensor somebody else owns, to write to.
struct OutputView {
  OutputView() = default;
  explicit OutputView(Tensor& tensor)
      : shape(tensor.shape), type(tensor.type), floats(tensor.floats), ints(tensor.ints) {}

  Shape shape;
  ElementType type = ElementType::kFloat;
  std::span<float> floats;
  std::span<int64_t> ints;
};

}  // namespace msf
