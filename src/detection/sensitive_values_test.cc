#include "detection/sensitive_values.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "detection/compiled_network.h"
#include "detection/test_networks.h"

namespace msf {
namespace {

constexpr CalibrationOptions kSize{96, 64};

StatusOr<cv::Mat> TestImage(int i) {
  cv::Mat image(50, 80, CV_8UC3, cv::Scalar(40 * i, 90, 200 - 30 * i));
  cv::rectangle(image, {10 + 10 * i, 5, 30, 35}, cv::Scalar(250, 200, 10), cv::FILLED);
  return image;
}

const CalibrationImages kImages{3, TestImage};

Graph TestGraph() { return TestNetwork(TestNetworkOptions()).builder().Parse().value(); }

ActivationRanges Ranges(const Graph& graph) {
  return Calibrate(graph, kSize, kImages, [](int) {}).value();
}

// How many convolutions run in 8 bits with these ranges.
int NumInt8(Graph graph, const ActivationRanges& ranges) {
  graph.metadata[kActivationRangesKey] = FormatActivationRanges(ranges);
  const CompileOptions compile{64, 96, NetworkPrecision::kInt8};
  return CompiledNetwork::Compile(graph, compile).value()->num_int8_convolutions();
}

TEST(FindSensitiveValues, NamesTheValueWhoseStepsAreTooCoarse) {
  const Graph graph = TestGraph();
  ActivationRanges ranges = Ranges(graph);
  // Of all values whose range is used, spoil one.
  std::string spoiled;
  for (const auto& [name, range] : ranges) {
    ActivationRanges others = ranges;
    others.erase(name);
    if (NumInt8(graph, others) < NumInt8(graph, ranges)) spoiled = name;
  }
  ASSERT_FALSE(spoiled.empty());
  ranges[spoiled].high *= 2000;
  SensitivityOptions options;
  options.max_share = 1;  // of few convolutions, each is much
  int done = 0, total = -1;
  const SensitiveValues found =
      FindSensitiveValues(graph, ranges, kSize, options, kImages, [&](int trials, int all) {
        EXPECT_GE(trials, done);
        done = trials;
        total = all;
      }).value();
  ASSERT_FALSE(found.names.empty());
  // Pieces of one concatenation share their steps, so that its name may be that of a neighbour.
  ActivationRanges without = ranges;
  without.erase(found.names[0]);
  const int num_int8 = NumInt8(graph, without);
  EXPECT_LT(num_int8, NumInt8(graph, ranges));
  without.erase(spoiled);
  EXPECT_EQ(NumInt8(graph, without), num_int8);
  EXPECT_LT(found.error_without, 0.5 * found.error_with);
  EXPECT_EQ(done, total);
}

TEST(FindSensitiveValues, NamesNoMoreThanWanted) {
  const Graph graph = TestGraph();
  const ActivationRanges ranges = Ranges(graph);
  SensitivityOptions options;
  options.max_share = 1;
  options.max_values = 0;
  const auto find = [&] {
    return FindSensitiveValues(graph, ranges, kSize, options, kImages, [](int, int) {}).value();
  };
  EXPECT_TRUE(find().names.empty());
  options.max_values = 1000000000;  // more than there are
  EXPECT_LE(find().names.size(), ranges.size());
  options.max_values = 2;
  options.min_gain = 0;
  EXPECT_LE(find().names.size(), 2u);
  options.min_gain = 1;  // nothing gains so much
  EXPECT_TRUE(find().names.empty());
}

TEST(FindSensitiveValues, SpendsNoMoreThanWanted) {
  const Graph graph = TestGraph();
  const ActivationRanges ranges = Ranges(graph);
  SensitivityOptions options;
  options.min_gain = -1;  // take whatever there is
  const auto find = [&] {
    return FindSensitiveValues(graph, ranges, kSize, options, kImages, [](int, int) {}).value();
  };
  options.max_share = 1;
  const SensitiveValues most = find();
  ASSERT_GT(most.share, 0);
  options.max_share = 0.5 * most.share;
  EXPECT_LE(find().share, options.max_share);
  options.max_share = 0;
  EXPECT_TRUE(find().names.empty());
}

TEST(FindSensitiveValues, SaysWhichImageIsDamaged) {
  const Graph graph = TestGraph();
  const auto failing = [](int) -> StatusOr<cv::Mat> { return Status::Error("x.jpg: damaged"); };
  const auto found = FindSensitiveValues(graph, Ranges(graph), kSize, SensitivityOptions(),
                                         {1, failing}, [](int, int) {});
  ASSERT_FALSE(found.ok());
  EXPECT_EQ(found.status().message(), "x.jpg: damaged");
}

}  // namespace
}  // namespace msf
