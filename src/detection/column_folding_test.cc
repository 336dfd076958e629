#include "detection/column_folding.h"

#include <gtest/gtest.h>

#include <random>

namespace msf {
namespace {

std::vector<float> Random(size_t count) {
  std::mt19937 random(5);
  std::normal_distribution<float> normal;
  std::vector<float> values(count);
  for (float& value : values) value = normal(random);
  return values;
}

std::vector<float> Execute(const ConvolutionSpec& spec, std::vector<float> input,
                           std::vector<float> addend) {
  std::vector<float> output(static_cast<size_t>(NumElements(spec.output_shape)));
  const auto step = MakeConvolutionStep(spec, {input.data(), addend.data(), output.data()});
  std::vector<std::byte> scratch(step->ScratchBytes() + 64);
  step->SetScratch(scratch.data());
  EXPECT_TRUE(step->Run().ok());
  return output;
}

// Kernel, stride, channels in and out.
class ColumnFolding : public testing::TestWithParam<std::array<int64_t, 4>> {};

TEST_P(ColumnFolding, ComputesTheSame) {
  const auto [kernel, stride, in, out] = GetParam();
  const Tensor weights = Tensor::Floats({out, in, kernel, kernel},
                                        Random(static_cast<size_t>(out * in * kernel * kernel)));
  const Tensor bias = Tensor::Floats({out}, Random(static_cast<size_t>(out)));
  ConvolutionSpec spec;
  spec.input_shape = {1, in, 6 * stride, 8 * stride};
  spec.output_shape = {1, out, 6, 8};
  for (int d = 0; d < 2; ++d) {
    spec.window.kernel[d] = kernel;
    spec.window.stride[d] = stride;
    spec.window.pad_begin[d] = spec.window.pad_end[d] = kernel / 2;
    spec.window.output[d] = spec.output_shape[static_cast<size_t>(d) + 2];
  }
  spec.weights = &weights;
  spec.bias = &bias;
  spec.epilogue.activation = Activation::kSilu;
  spec.epilogue.addend = 1;
  spec.epilogue.add_first = true;
  spec.epilogue.scale = Random(static_cast<size_t>(out));
  spec.epilogue.shift = Random(static_cast<size_t>(out));
  spec.input = spec.output = spec.addend = {NumberFormat::kFloat32, true};
  const std::vector<float> input = Random(static_cast<size_t>(NumElements(spec.input_shape)));
  const std::vector<float> addend = Random(static_cast<size_t>(NumElements(spec.output_shape)));
  Tensor folded_weights, folded_bias;
  const ConvolutionSpec folded = FoldColumns(spec, 2, folded_weights, folded_bias);
  EXPECT_EQ(folded.input_shape[1], in * 2 * stride);
  const std::vector<float> expected = Execute(spec, input, addend),
                           actual = Execute(folded, input, addend);
  for (size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(actual[i], expected[i], 1e-4) << i;
}

INSTANTIATE_TEST_SUITE_P(Windows, ColumnFolding,
                         testing::Values(std::array<int64_t, 4>{3, 1, 8, 8},
                                         std::array<int64_t, 4>{5, 1, 8, 24},
                                         std::array<int64_t, 4>{3, 2, 3, 8},
                                         std::array<int64_t, 4>{7, 1, 4, 4}));

}  // namespace
}  // namespace msf
