#include "detection/detection_metrics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace msf {
namespace {

constexpr ImageBox kA{0, 0, 10, 10}, kB{20, 0, 30, 10}, kFar{50, 50, 60, 60};

Detection Found(float score, const ImageBox& box, int class_id = 0) {
  return {class_id, score, box};
}

TEST(IntersectionOverUnion, OfShiftedAndEmptyBoxes) {
  EXPECT_FLOAT_EQ(IntersectionOverUnion(kA, kA), 1.0f);
  EXPECT_FLOAT_EQ(IntersectionOverUnion(kA, {5, 0, 15, 10}), 50.0f / 150.0f);
  EXPECT_FLOAT_EQ(IntersectionOverUnion(kA, kB), 0.0f);
  EXPECT_FLOAT_EQ(IntersectionOverUnion({3, 3, 3, 3}, {3, 3, 3, 3}), 0.0f);
}

TEST(SuppressOverlaps, KeepsTheBestOfItsClass) {
  const std::vector<Detection> kept =
      SuppressOverlaps({Found(0.5f, {1, 0, 11, 10}), Found(0.9f, kA), Found(0.4f, kA, 1),
                        Found(0.6f, kB), Found(0.1f, kFar)},
                       {.max_iou = 0.7f, .max_count = 3});
  ASSERT_EQ(kept.size(), 3u);
  EXPECT_FLOAT_EQ(kept[0].score, 0.9f);
  EXPECT_FLOAT_EQ(kept[1].score, 0.6f);
  EXPECT_FLOAT_EQ(kept[2].score, 0.4f);  // another class at the same place stays
}

TEST(SuppressOverlaps, OverlappedOnesLoseScore) {
  const ImageBox shifted{5, 0, 15, 10};  // overlaps kA by a third
  const OverlapRule rule{.max_iou = 0.7f, .decay = 0.5f, .min_score = 0.25f};
  const std::vector<Detection> kept = SuppressOverlaps(
      {Found(0.8f, shifted), Found(0.9f, kA), Found(0.7f, kB), Found(0.75f, shifted, 1)}, rule);
  ASSERT_EQ(kept.size(), 4u);
  EXPECT_FLOAT_EQ(kept[1].score, 0.75f);  // another class keeps its score
  EXPECT_FLOAT_EQ(kept[2].score, 0.7f);
  EXPECT_NEAR(kept[3].score, 0.8 * std::exp(-(1.0 / 9) / 0.5), 1e-6);

  // 0.3 falls below the least score.
  EXPECT_EQ(SuppressOverlaps({Found(0.3f, shifted), Found(0.9f, kA)}, rule).size(), 1u);
  EXPECT_EQ(SuppressOverlaps({Found(0.3f, shifted), Found(0.9f, kA)}, {}).size(), 2u);
}

// Two objects; the first detection is right, the second wrong, the third right.
std::vector<ScoredImage> TwoOfThree() {
  return {{{{0, kA}, {0, kB}}, {Found(0.9f, kA), Found(0.8f, kFar), Found(0.7f, kB)}}};
}

TEST(ComputeMetrics, AveragePrecisionByHand) {
  const DetectionMetrics metrics = ComputeMetrics(TwoOfThree(), 1, 1);
  // Recall 0.5, 0.5, 1; envelope of the precision 1, 2/3, 2/3. Between recall 0 and 0.5 it is 1; at
  // 0.5 the last point with that recall counts (2/3), and it stays so until the end, where it falls
  // to 0 within the last sample.
  const double expected =
      0.49 * 1 + 0.01 * (1 + 2.0 / 3) / 2 + 0.49 * 2 / 3 + 0.01 * (2.0 / 3 + 0) / 2;
  EXPECT_NEAR(metrics.map50, expected, 1e-9);
  EXPECT_NEAR(metrics.map50_95, expected, 1e-9);  // the boxes fit exactly
  EXPECT_EQ(metrics.num_classes, 1);
}

TEST(ComputeMetrics, PreciseBoxesCountAtHighThresholds) {
  // IoU 8/12 = 0.667: right at 0.50, 0.55, 0.60 and 0.65.
  const std::vector<ScoredImage> images{{{{0, kA}}, {Found(0.9f, {2, 0, 12, 10})}}};
  const DetectionMetrics metrics = ComputeMetrics(images, 1, 1);
  EXPECT_NEAR(metrics.map50, 0.995, 1e-9);  // 1 up to recall 0.99, then down to 0
  EXPECT_NEAR(metrics.map50_95, 0.4 * 0.995, 1e-9);
}

TEST(ComputeMetrics, TheStrongestOfTwoOnOneObjectIsRight) {
  const std::vector<ScoredImage> images{
      {{{0, kA}}, {Found(0.6f, kA), Found(0.9f, {1, 0, 11, 10})}}};
  const ClassMetrics c = ComputeMetrics(images, 1, 1).per_class[0];
  ASSERT_EQ(c.curve.size(), 2u);
  EXPECT_DOUBLE_EQ(c.curve[0].precision, 1.0);
  EXPECT_DOUBLE_EQ(c.curve[1].precision, 0.5);
}

TEST(ComputeMetrics, OperatingPointMaximisesF1) {
  // Right down to 0.6, then wrong ones only: the best confidence lies between 0.3 and 0.6.
  std::vector<ScoredImage> images;
  images.reserve(10);
  for (int i = 0; i < 4; ++i)
    images.push_back({{{0, kA}}, {Found(0.6f + 0.1f * static_cast<float>(i), kA)}});
  for (int i = 0; i < 6; ++i)
    images.push_back({{}, {Found(0.3f - 0.01f * static_cast<float>(i), kFar)}});
  const DetectionMetrics metrics = ComputeMetrics(images, 1, 1);
  EXPECT_GT(metrics.confidence, 0.3);
  EXPECT_LT(metrics.confidence, 0.6);
  EXPECT_NEAR(metrics.recall, 1, 0.02);
  EXPECT_GT(metrics.precision, 0.8);
}

TEST(ComputeMetrics, IgnoredObjectsAndRareClassesDoNotCount) {
  const std::vector<ScoredImage> images{
      {{{0, kA}, {0, kB, true}, {1, kFar}}, {Found(0.9f, kB), Found(0.8f, kA)}}};
  const DetectionMetrics metrics = ComputeMetrics(images, 2, 1);
  EXPECT_EQ(metrics.per_class[0].num_objects, 1);
  EXPECT_NEAR(metrics.per_class[0].ap50, 0.995,
              1e-9);  // the detection on the ignored one is no error
  EXPECT_EQ(metrics.per_class[1].ap50, 0);
  EXPECT_NEAR(metrics.map50, 0.995 / 2, 1e-9);
  EXPECT_EQ(ComputeMetrics(images, 2, 2).num_classes, 0);
}

TEST(ComputeRecallAtFalseRate, StopsAtTheAllowedErrors) {
  std::vector<ScoredImage> images = TwoOfThree();
  images.resize(5);  // four empty images: 0.2 wrong boxes per image allow one
  RecallAtFalseRate result = ComputeRecallAtFalseRate(images, 0, 0.2);
  EXPECT_DOUBLE_EQ(result.recall, 1.0);
  EXPECT_EQ(result.num_false, 1);
  EXPECT_FLOAT_EQ(static_cast<float>(result.score), 0.7f);
  images.resize(4);  // now none is
  result = ComputeRecallAtFalseRate(images, 0, 0.2);
  EXPECT_DOUBLE_EQ(result.recall, 0.5);
  EXPECT_FLOAT_EQ(static_cast<float>(result.score), 0.9f);
}

TEST(ComputeRecallAtFalseRate, ASecondBoxOnAnObjectIsWrong) {
  const std::vector<ScoredImage> images{
      {{{0, kA}, {0, kB}}, {Found(0.9f, kA), Found(0.8f, {1, 0, 11, 10}), Found(0.7f, kB)}}};
  EXPECT_DOUBLE_EQ(ComputeRecallAtFalseRate(images, 0, 0.5).recall, 0.5);
  EXPECT_DOUBLE_EQ(ComputeRecallAtFalseRate(images, 0, 1.0).recall, 1.0);
}

TEST(FormatMetrics, NamesClassesWithObjects) {
  const std::string text = FormatMetrics(ComputeMetrics(TwoOfThree(), 2, 1), {"person", "sofa"});
  EXPECT_NE(text.find("person"), std::string::npos);
  EXPECT_EQ(text.find("sofa"), std::string::npos);
}

}  // namespace
}  // namespace msf
