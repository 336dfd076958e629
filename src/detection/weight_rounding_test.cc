#include "detection/weight_rounding.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "detection/calibration.h"
#include "detection/compiled_network.h"
#include "detection/test_onnx_builder.h"

namespace msf {
namespace {

TEST(RoundWeights, GivesEveryChannelAScaleOfItsOwn) {
  const RoundedWeights rounded =
      RoundWeights(Tensor::Floats({2, 1, 1, 3}, {1.27f, -0.5f, 0.014f, 0, 0, 0}), 127);
  EXPECT_EQ(rounded.values, (std::vector<int8_t>{127, -50, 1, 0, 0, 0}));
  EXPECT_NEAR(rounded.scales[0], 0.01, 1e-6);
  EXPECT_EQ(rounded.sums, (std::vector<float>{78, 0}));
}

TEST(RoundWeights, HasNoLargerNumbersThanItMay) {
  const RoundedWeights rounded =
      RoundWeights(Tensor::Floats({1, 1, 1, 3}, {-1.28f, 0.5f, 0.014f}), 64);
  EXPECT_EQ(rounded.values, (std::vector<int8_t>{-64, 25, 1}));
  EXPECT_NEAR(rounded.scales[0], 0.02, 1e-6);
}

// Of the three convolutions the second, with `group`, has one large weight per output channel next
// to small ones that all round to 0.
Graph ThreeConvolutions(int64_t group) {
  constexpr int64_t kChannels = 8;
  OnnxBuilder n;
  const std::string x = n.Input("images", {1, 3, 32, 32});
  const std::string y = n.ConvSilu(x, 3, kChannels, 1, 1);
  const int64_t per_channel = kChannels / group * 9;
  std::vector<float> weights;
  for (int64_t i = 0; i < kChannels * per_channel; ++i)
    weights.push_back(i % per_channel == 0 ? 1.27f : 0.004f);
  onnx::NodeProto& rough =
      n.Add("Conv", {y, n.Floats({kChannels, kChannels / group, 3, 3}, weights)});
  OnnxBuilder::Set(rough, "group", group);
  n.Output(n.Conv(n.Silu(rough.output(0)), kChannels, 4, 1));
  return n.Parse().value();
}

// The mean of every channel of the output, over an image of noise.
std::vector<float> MeanOutputs(const Graph& graph, NetworkPrecision precision,
                               ActivationRanges* ranges = nullptr) {
  CompileOptions options{32, 32, precision};
  options.keep_values = ranges != nullptr;
  const auto network = CompiledNetwork::Compile(graph, options).value();
  for (int i = 0; i < 32 * 32 * 3; ++i) network->pixels()[i] = static_cast<uint8_t>(i * 7919 % 256);
  EXPECT_TRUE(network->Run().ok());
  const auto means = [](const NetworkOutput& value) {
    ChannelMeans channels;
    channels.Count(value.numbers(), static_cast<size_t>(value.shape[1]), value.channels_last);
    return channels.Means();
  };
  if (ranges != nullptr) {
    for (const NetworkOutput& value : network->inner_values()) {
      const auto [low, high] = std::minmax_element(value.numbers().begin(), value.numbers().end());
      (*ranges)[value.name] = {*low, *high, means(value)};
    }
  }
  return means(network->outputs()[0]);
}

double Distance(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += std::pow(a[i] - b[i], 2);
  return std::sqrt(sum);
}

class CorrectRoundedWeightsTest : public testing::TestWithParam<int> {};

TEST_P(CorrectRoundedWeightsTest, KeepsTheMeanOfTheResults) {
  Graph graph = ThreeConvolutions(GetParam());
  ActivationRanges ranges;
  const std::vector<float> exact = MeanOutputs(graph, NetworkPrecision::kFloat32, &ranges);
  graph.metadata[kActivationRangesKey] = FormatActivationRanges(ranges);
  const double corrected = Distance(MeanOutputs(graph, NetworkPrecision::kInt8), exact);
  for (auto& [name, range] : ranges) range.means.clear();
  graph.metadata[kActivationRangesKey] = FormatActivationRanges(ranges);
  const double plain = Distance(MeanOutputs(graph, NetworkPrecision::kInt8), exact);
  EXPECT_LT(corrected, 0.4 * plain);
}

INSTANTIATE_TEST_SUITE_P(Groups, CorrectRoundedWeightsTest, testing::Values(1, 8));

TEST(CorrectRoundedWeights, SaysWhenMeansAreMissing) {
  Graph graph = ThreeConvolutions(1);
  ActivationRanges ranges;
  MeanOutputs(graph, NetworkPrecision::kFloat32, &ranges);
  for (auto& [name, range] : ranges) range.means.pop_back();
  graph.metadata[kActivationRangesKey] = FormatActivationRanges(ranges);
  const auto network = CompiledNetwork::Compile(graph, {32, 32, NetworkPrecision::kInt8});
  ASSERT_FALSE(network.ok());
  EXPECT_NE(network.status().message().find("the means of 7; quantise it again"), std::string::npos)
      << network.status().message();
}

}  // namespace
}  // namespace msf
