#include "dynamic/camera_motion.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "dynamic/test_scene.h"

namespace msf {
namespace {

class CameraMotionTest : public ::testing::Test {
 protected:
  // Points that stand still, anywhere in the image, 1.5 m to 4 m away.
  void AddStatic(int count) {
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector2f px(Uniform(60, 580), Uniform(60, 420));
      AddFeature(px, Uniform(1.5f, 4), features_);
      const Eigen::Vector3d p =
          T_past_now_ * features_.PointInCamera(features_.size() - 1, *TestCamera());
      flow_.push_back({TestCamera()->Project(p).cast<float>(), true});
    }
  }
  // Points that landed anywhere.
  void AddWild(int count) {
    for (int i = 0; i < count; ++i) {
      AddFeature({Uniform(60, 580), Uniform(60, 420)}, Uniform(1.5f, 4), features_);
      flow_.push_back({{Uniform(60, 580), Uniform(60, 420)}, true});
    }
  }
  CameraMotion Estimate(const Rigid3d& predicted) {
    std::vector<int> all(features_.size());
    std::iota(all.begin(), all.end(), 0);
    return EstimateCameraMotion(*TestCamera(), TestLevels(), features_, all, flow_, predicted, 3);
  }
  double ErrorOf(const CameraMotion& motion) const {
    return (motion.T_past_now * T_past_now_.Inverse()).Log().norm();
  }
  float Uniform(float low, float high) {
    return low + (high - low) * static_cast<float>(random_()) * 0x1p-32f;
  }
  const Rigid3d T_past_now_ =
      Rigid3d::Exp((Vector6d() << 0.05, -0.02, 0.03, 0.01, 0.02, -0.01).finished());
  std::mt19937 random_{5};
  FrameFeatures features_;
  std::vector<FlowPoint> flow_;
};

TEST_F(CameraMotionTest, FollowsPointsThatStandStill) {
  AddStatic(60);
  const CameraMotion motion = Estimate({});
  EXPECT_TRUE(motion.reliable);
  EXPECT_EQ(motion.num_points, 60);
  EXPECT_EQ(motion.num_inliers, 60);
  EXPECT_LT(ErrorOf(motion), 1e-4);
}

TEST_F(CameraMotionTest, IsNotMisledByAMover) {
  AddStatic(60);
  for (int i = 0; i < 20; ++i) flow_[i].image_px += Eigen::Vector2f(15, 4);
  const CameraMotion motion = Estimate(T_past_now_);
  EXPECT_TRUE(motion.reliable);
  EXPECT_EQ(motion.num_inliers, 40);
  EXPECT_LT(ErrorOf(motion), 1e-3);
}

TEST_F(CameraMotionTest, FromABadPredictionAConsensusIsSought) {
  AddStatic(60);
  AddWild(40);
  const CameraMotion motion =
      Estimate(Rigid3d::Exp((Vector6d() << 0.6, -0.4, 0.5, -0.3, 0.4, 0.6).finished()));
  EXPECT_TRUE(motion.reliable);
  EXPECT_GE(motion.num_inliers, 60);
  EXPECT_LT(ErrorOf(motion), 1e-3);
}

TEST_F(CameraMotionTest, WithTooFewPointsItIsThePrediction) {
  AddStatic(17);
  flow_[0].found = false;
  features_.depth_m[1] = features_.depth_m[2] = 0;
  const Rigid3d predicted = Rigid3d::Exp((Vector6d() << 0.1, 0, 0, 0, 0, 0).finished());
  const CameraMotion motion = Estimate(predicted);
  EXPECT_FALSE(motion.reliable);
  EXPECT_EQ(motion.num_points, 14);
  EXPECT_EQ(motion.T_past_now.translation(), predicted.translation());
}

TEST_F(CameraMotionTest, WhatAFewPointsAmongManyAgreeOnIsNoMotionOfTheCamera) {
  AddStatic(20);
  AddWild(100);
  const CameraMotion motion = Estimate(T_past_now_);
  EXPECT_FALSE(motion.reliable);
}

// Landmarks of the past image, seen now.
class LandmarkMotionTest : public CameraMotionTest {
 protected:
  void Add(int count, const Eigen::Vector2f& moved_px = {0, 0}) {
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector2f px(Uniform(60, 580), Uniform(60, 420));
      landmarks_.push_back({px, TestCamera()->Unproject(px.cast<double>(), Uniform(1.5f, 4))});
      const Eigen::Vector3d p_now = T_past_now_.Inverse() * landmarks_.back().p_c;
      flow_.push_back({TestCamera()->Project(p_now).cast<float>() + moved_px, true});
    }
  }
  CameraMotion Estimate(const Rigid3d& predicted) {
    return EstimateCameraMotion(*TestCamera(), landmarks_, flow_, predicted, 3);
  }
  std::vector<Landmark> landmarks_;
};

TEST_F(LandmarkMotionTest, TellTheCamerasMotion) {
  Add(40);
  Add(15, {20, 5});
  const CameraMotion motion = Estimate({});
  EXPECT_TRUE(motion.reliable);
  EXPECT_EQ(motion.num_points, 55);
  EXPECT_EQ(motion.num_inliers, 40);
  EXPECT_LT(ErrorOf(motion), 1e-3);
}

TEST_F(LandmarkMotionTest, TellNothingWhenTheyAreFewOrDisagree) {
  const Rigid3d predicted = Rigid3d::Exp((Vector6d() << 0.1, 0, 0, 0, 0, 0).finished());
  Add(11);
  EXPECT_FALSE(Estimate(predicted).reliable);
  EXPECT_EQ(Estimate(predicted).T_past_now.translation(), predicted.translation());
  Add(1);
  EXPECT_TRUE(Estimate(predicted).reliable);
  flow_[3].found = false;
  EXPECT_FALSE(Estimate(predicted).reliable);
  landmarks_.clear();
  flow_.clear();
  Add(40);
  for (FlowPoint& point : flow_) point.image_px = {Uniform(60, 580), Uniform(60, 420)};
  EXPECT_FALSE(Estimate(predicted).reliable);
}

TEST_F(CameraMotionTest, WithoutAgreementItIsThePrediction) {
  AddWild(40);
  const CameraMotion motion = Estimate({});
  EXPECT_FALSE(motion.reliable);
  EXPECT_EQ(motion.num_points, 40);
  EXPECT_EQ(motion.T_past_now.Log().norm(), 0);
}

}  // namespace
}  // namespace msf
