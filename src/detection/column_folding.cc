#include "detection/column_folding.h"

#include <algorithm>

namespace msf {
namespace {

// Floor of a / b for b > 0.
int64_t FloorDivide(int64_t a, int64_t b) { return (a >= 0 ? a : a - b + 1) / b; }

std::vector<float> Repeat(const std::vector<float>& values, int64_t times) {
  std::vector<float> repeated;
  for (int64_t i = 0; i < times && !values.empty(); ++i)
    repeated.insert(repeated.end(), values.begin(), values.end());
  return repeated;
}

}  // namespace

int FoldingFactor(const ConvolutionSpec& spec) {
  const Window& w = spec.window;
  const int64_t in = spec.input_shape[1], out = spec.output_shape[1];
  if (spec.compute == NumberFormat::kFloat32 || !HasMatrixUnit()) return 1;
  if (spec.group != 1 || w.kernel[1] < 3 || w.dilation[1] != 1 || spec.output_shape[3] % 2 != 0 ||
      spec.output_shape[3] * w.stride[1] != spec.input_shape[3]) {
    return 1;
  }
  // Measured: with more channels the zeros cost more than the fuller blocks gain.
  if (w.stride[1] == 1) return in <= 8 ? 2 : 1;
  return w.stride[1] == 2 && in <= 4 && (spec.compute == NumberFormat::kBfloat16 || out <= 8) ? 2
                                                                                              : 1;
}

ConvolutionSpec FoldColumns(const ConvolutionSpec& spec, int factor, Tensor& weights,
                            Tensor& bias) {
  const Window& w = spec.window;
  const Shape& from = spec.weights->shape;
  const int64_t out = from[0], in = from[1], stride = w.stride[1], group = factor * stride;
  const int64_t first = FloorDivide(-w.pad_begin[1], group);
  const int64_t last = FloorDivide((factor - 1) * stride - w.pad_begin[1] + w.kernel[1] - 1, group);
  const int64_t kernel = last - first + 1;
  weights = Tensor::Zeros(ElementType::kFloat, {factor * out, group * in, from[2], kernel});
  const Shape to_strides = DenseStrides(weights.shape), from_strides = DenseStrides(from);
  for (int64_t i = 0; i < NumElements(from); ++i) {
    const int64_t o = i / from_strides[0], c = i / from_strides[1] % in,
                  y = i / from_strides[2] % from[2], x = i % from[3];
    for (int64_t j = 0; j < factor; ++j) {
      const int64_t column =
          j * stride - w.pad_begin[1] + x;  // relative to the first input pixel of the group
      const int64_t place = FloorDivide(column, group);
      const int64_t channel = (column - place * group) * in + c;
      weights.floats[static_cast<size_t>((j * out + o) * to_strides[0] + channel * to_strides[1] +
                                         y * to_strides[2] + place - first)] =
          spec.weights->floats[static_cast<size_t>(i)];
    }
  }
  ConvolutionSpec folded = spec;
  folded.weights = &weights;
  if (spec.bias) {
    bias = Tensor::Floats({factor * out}, Repeat(spec.bias->floats, factor));
    folded.bias = &bias;
  }
  folded.epilogue.scale = Repeat(spec.epilogue.scale, factor);
  folded.epilogue.shift = Repeat(spec.epilogue.shift, factor);
  folded.input_shape = {1, group * in, spec.input_shape[2], spec.input_shape[3] / group};
  folded.output_shape = {1, factor * out, spec.output_shape[2], spec.output_shape[3] / factor};
  folded.window.kernel[1] = kernel;
  folded.window.stride[1] = 1;
  folded.window.pad_begin[1] = -first;
  folded.window.pad_end[1] = last;
  folded.window.output[1] = folded.output_shape[3];
  return folded;
}

}  // namespace msf
