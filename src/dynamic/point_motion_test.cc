#include "dynamic/point_motion.h"

#include <gtest/gtest.h>

#include <numeric>

#include "dynamic/test_scene.h"

namespace msf {
namespace {

// The camera has moved by 10 cm to the left since: a point 2 m away was 525 * 0.1 / 2 = 26.25 px
// farther right.
constexpr float kDepth_m = 2, kShift_px = 26.25f;

PastView MakePast(float depth_m) {
  PastView past;
  past.depth = CoarseDepth(DepthFrame(depth_m));
  past.T_past_now = Rigid3d(Eigen::Quaterniond::Identity(), {0.1, 0, 0});
  return past;
}

// Points in a row, 2 m away, each of which landed `off_px` below where a static one would have.
class PointMotionTest : public ::testing::Test {
 protected:
  void Add(float off_px, float depth_m = kDepth_m) {
    const Eigen::Vector2f px(100 + 10 * static_cast<float>(features_.size()), 240);
    AddFeature(px, depth_m, features_);
    flow_.push_back({px + Eigen::Vector2f(kShift_px, off_px), true});
  }
  std::vector<PointMotion> Test() {
    std::vector<int> all(features_.size());
    std::iota(all.begin(), all.end(), 0);
    on_object_.resize(all.size(), 0);
    return TestMotion(*TestCamera(), TestLevels(), features_, {all, flow_, on_object_}, past_, {});
  }
  FrameFeatures features_;
  std::vector<uint8_t> on_object_;  // of the first points; the others are on none
  std::vector<FlowPoint> flow_;
  PastView past_ = MakePast(kDepth_m);
};

TEST_F(PointMotionTest, PredictsPointsByTheirDepth) {
  AddFeature({100, 200}, 2, features_);
  AddFeature({100, 200}, 0, features_);  // as if 50 m away
  AddFeature({300, 200}, 2, features_);
  const std::vector<int> which = {2, 0, 1};
  const std::vector<Eigen::Vector2f> predicted =
      PredictInPast(*TestCamera(), features_, which, past_.T_past_now);
  ASSERT_EQ(predicted.size(), 3u);
  EXPECT_TRUE(predicted[0].isApprox(Eigen::Vector2f(326.25f, 200)));
  EXPECT_TRUE(predicted[1].isApprox(Eigen::Vector2f(126.25f, 200)));
  EXPECT_TRUE(predicted[2].isApprox(Eigen::Vector2f(101.05f, 200)));
}

TEST_F(PointMotionTest, APointThatWasBehindTheCameraIsLookedForWhereItIs) {
  AddFeature({100, 200}, 2, features_);
  const std::vector<int> which = {0};
  const Rigid3d backward(Eigen::Quaterniond::Identity(), {0, 0, -3});
  EXPECT_EQ(PredictInPast(*TestCamera(), features_, which, backward)[0], Eigen::Vector2f(100, 200));
}

// At 2 m depth has a noise of 0.006 m + 4 * 0.004 m = 0.022 m, which moves the prediction by 26.25
// px * 0.022 / 2 = 0.29 px; with the flow's 0.35 px that makes three sigmas of 1.36 px, less than
// the 1.5 px that never count. With 8 % of the camera's flow the tolerance is 3.6 px.
TEST_F(PointMotionTest, FlowBeyondItsToleranceIsMotion) {
  for (int i = 0; i < 5; ++i) Add(0);
  Add(3.5f);
  Add(3.7f);
  Add(-3.7f);
  const std::vector<PointMotion> verdicts = Test();
  for (int i = 0; i < 6; ++i) EXPECT_EQ(verdicts[i], PointMotion::kStatic) << i;
  EXPECT_EQ(verdicts[6], PointMotion::kMovesSideways);
  EXPECT_EQ(verdicts[7], PointMotion::kMovesSideways);
}

// At level 4 the flow's noise is 1.2^4 * 0.35 px = 0.73 px; the tolerance 4.44 px.
TEST_F(PointMotionTest, PointsOfHigherLevelsAreLessExact) {
  for (int i = 0; i < 5; ++i) Add(0);
  Add(4.3f);
  Add(4.6f);
  features_.level[5] = features_.level[6] = 4;
  const std::vector<PointMotion> verdicts = Test();
  EXPECT_EQ(verdicts[5], PointMotion::kStatic);
  EXPECT_EQ(verdicts[6], PointMotion::kMovesSideways);
}

// A turn that changes by 0.02 rad from image to image: 0.5 * 525 px * 0.02 = 5.25 px more.
TEST_F(PointMotionTest, WhileTheMotionChangesMoreIsTolerated) {
  for (int i = 0; i < 5; ++i) Add(0);
  Add(8.8f);
  Add(8.9f);
  past_.unsteadiness[4] = 0.02;
  const std::vector<PointMotion> verdicts = Test();
  EXPECT_EQ(verdicts[5], PointMotion::kStatic);
  EXPECT_EQ(verdicts[6], PointMotion::kMovesSideways);
}

// Most are off by half of their tolerance instead of 0.3 of it: all tolerances grow by 5 / 3.
TEST_F(PointMotionTest, WhatMostPointsDeviateByIsNoise) {
  for (int i = 0; i < 10; ++i) Add(1.8f);
  Add(5.9f);
  Add(6.1f);
  const std::vector<PointMotion> verdicts = Test();
  EXPECT_EQ(verdicts[0], PointMotion::kStatic);
  EXPECT_EQ(verdicts[10], PointMotion::kStatic);
  EXPECT_EQ(verdicts[11], PointMotion::kMovesSideways);
}

// Or an object that fills most of the image would make its own motion the noise.
TEST_F(PointMotionTest, PointsOnObjectsDoNotTellTheNoise) {
  for (int i = 0; i < 20; ++i) Add(6);
  for (int i = 0; i < 10; ++i) Add(0.5f);
  EXPECT_EQ(Test()[0], PointMotion::kStatic) << "most points agree that it is noise";
  on_object_.assign(20, 1);
  on_object_.resize(30, 0);
  EXPECT_EQ(Test()[0], PointMotion::kMovesSideways);
  EXPECT_EQ(Test()[29], PointMotion::kStatic);
}

// Twice three sigmas: 0.132 m.
TEST_F(PointMotionTest, DepthThatDiffersIsMotion) {
  Add(0);
  past_.depth = CoarseDepth(DepthFrame(kDepth_m + 0.12f));
  EXPECT_EQ(Test()[0], PointMotion::kStatic);
  past_.depth = CoarseDepth(DepthFrame(kDepth_m + 0.14f));
  EXPECT_EQ(Test()[0], PointMotion::kMovesInDepth);
  past_.depth = CoarseDepth(DepthFrame(0));
  EXPECT_EQ(Test()[0], PointMotion::kStatic) << "no depth then";
}

TEST_F(PointMotionTest, AtAnEdgeEitherDepthMayBeRight) {
  Add(0);
  past_.depth = CoarseDepth(DepthFrame(kDepth_m, {{{0, 0, 128, 480}, 3}}));
  EXPECT_EQ(Test()[0], PointMotion::kStatic) << "landed at 126.25 px";
  past_.depth = CoarseDepth(DepthFrame(kDepth_m, {{{0, 0, 136, 480}, 3}}));
  EXPECT_EQ(Test()[0], PointMotion::kMovesInDepth);
}

TEST_F(PointMotionTest, WhatWasNotFoundIsNotTested) {
  Add(20);
  flow_[0].found = false;
  EXPECT_EQ(Test()[0], PointMotion::kUntested);
}

// Its place then lies between those of a point at 50 m and of one at 0.4 m: 1.05 px to 131.25 px
// to the right. The tolerance is 1.5 px + 8 % of the flow.
TEST_F(PointMotionTest, APointWithoutDepthMayHaveMovedAlongItsLine) {
  for (int i = 0; i < 5; ++i) Add(0, 0);
  flow_[0].image_px = features_.image_px[0] + Eigen::Vector2f(100, 0);
  flow_[1].image_px = features_.image_px[1] + Eigen::Vector2f(60, 20);  // tolerated: 6.6 px
  flow_[2].image_px = features_.image_px[2] - Eigen::Vector2f(3, 0);    // 4.05 px off
  const std::vector<PointMotion> verdicts = Test();
  EXPECT_EQ(verdicts[0], PointMotion::kStatic);
  EXPECT_EQ(verdicts[1], PointMotion::kMovesSideways);
  EXPECT_EQ(verdicts[2], PointMotion::kMovesSideways);
  EXPECT_EQ(verdicts[3], PointMotion::kStatic);
}

TEST(PointMotion, Moves) {
  EXPECT_FALSE(Moves(PointMotion::kUntested));
  EXPECT_FALSE(Moves(PointMotion::kStatic));
  EXPECT_TRUE(Moves(PointMotion::kMovesSideways));
  EXPECT_TRUE(Moves(PointMotion::kMovesInDepth));
}

}  // namespace
}  // namespace msf
