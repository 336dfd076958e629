#include "detection/calibration.h"

#include <gtest/gtest.h>

#include <random>

#include "detection/compiled_network.h"
#include "detection/onednn_detector.h"
#include "detection/test_networks.h"

namespace msf {
namespace {

TEST(ValueHistogram, KeepsTheWholeRangeOfUniformNumbers) {
  std::vector<float> numbers;
  for (int i = 0; i <= 1000; ++i) numbers.push_back(-1.0f + 0.003f * static_cast<float>(i));
  ValueHistogram histogram;
  histogram.Widen(numbers);
  histogram.Count(numbers);
  const ActivationRange range = histogram.BestRange();
  EXPECT_NEAR(range.low, -1, 0.05);
  EXPECT_NEAR(range.high, 2, 0.05);
}

TEST(ValueHistogram, CutsRareOutliers) {
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  std::vector<float> numbers(100000);
  for (float& x : numbers) x = std::abs(normal(random));
  const std::vector<float> outlier{60};
  ValueHistogram histogram;
  histogram.Widen(numbers);
  histogram.Widen(outlier);
  for (int i = 0; i < 20; ++i) histogram.Count(numbers);
  histogram.Count(outlier);
  EXPECT_LT(histogram.BestRange().high, 30);
  EXPECT_GT(histogram.BestRange().high, 3);
  EXPECT_EQ(histogram.BestRange().low, 0);
}

TEST(ChannelMeans, KnowBothOrdersOfMemory) {
  ChannelMeans means;
  means.Count(std::vector<float>{1, 10, 3, 20}, 2, true);
  means.Count(std::vector<float>{5, 7, 30, 40}, 2, false);
  EXPECT_EQ(means.Means(), (std::vector<float>{4, 25}));
}

TEST(ActivationRanges, SurviveTheirTextForm) {
  const ActivationRanges ranges{{"a/b", {-0.25f, 3.5f, {1.5f, -2.0f}}}, {"c", {0, 1, {}}}};
  const ActivationRanges back = ParseActivationRanges(FormatActivationRanges(ranges)).value();
  ASSERT_EQ(back.size(), 2u);
  EXPECT_EQ(back.at("a/b").high, 3.5f);
  EXPECT_EQ(back.at("a/b").means, (std::vector<float>{1.5f, -2.0f}));
  EXPECT_TRUE(back.at("c").means.empty());
  for (const char* damaged :
       {"", "[]", "{\"a\": 1}", "{\"a\": [2, 1]}", "{\"a\": [\"x\", 1]}", "{\"a\": [1, 2, 3]}",
        "{\"a\": [1, 2, [\"x\"]]}", "{\"a\": [1, 2, [1e300]]}"}) {
    EXPECT_FALSE(ParseActivationRanges(damaged).ok()) << damaged;
  }
}

TEST(Calibrate, GivesEveryConvolutionARange) {
  TestNetworkOptions options;
  options.msf = true;
  TestNetwork network(options);
  Graph graph = network.builder().Parse().value();
  int last = 0;
  const auto image = [](int i) -> StatusOr<cv::Mat> {
    return cv::Mat(50, 80, CV_8UC3, cv::Scalar(40 * i, 90, 200 - 30 * i));
  };
  const ActivationRanges ranges =
      Calibrate(graph, {96, 64}, {3, image}, [&](int done) { last = done; }).value();
  EXPECT_EQ(last, 6);
  ASSERT_EQ(ranges.at("images").means.size(), 3u);
  EXPECT_NEAR(ranges.at("images").means[1], 90.0 / 255, 0.06);  // letterboxed: grey at the border
  graph.metadata[kActivationRangesKey] = FormatActivationRanges(ranges);
  for (const auto merging : {CompileOptions::Merging::kNever, CompileOptions::Merging::kAlways}) {
    CompileOptions compile{64, 96, NetworkPrecision::kInt8};
    compile.merging = merging;
    const auto compiled = CompiledNetwork::Compile(graph, compile).value();
    // All but the six heads, the eleven readers of MSFConv's linear outputs and, unless merged, the
    // two pointwise convolutions of each of the seven blocks.
    const int higher = 6 + 11 + (merging == CompileOptions::Merging::kNever ? 14 : 0);
    EXPECT_EQ(compiled->num_convolutions() - compiled->num_int8_convolutions(), higher);
  }
  const auto failing = [](int) -> StatusOr<cv::Mat> { return Status::Error("x.jpg: damaged"); };
  EXPECT_EQ(Calibrate(graph, {96, 64}, {1, failing}, [](int) {}).message(), "x.jpg: damaged");
}

}  // namespace
}  // namespace msf
