#include "mapping/local_bundle.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "map/test_world.h"

namespace msf {
namespace {

class LocalBundleTest : public ::testing::Test {
 protected:
  LocalBundleTest()
      : keyframes_(world_.Walk(0, 0.75, 0.1, Vector6d::Zero(), TestWorld::PoseOnCircle(0), map_)) {
    options_.max_bundle_keyframes = 3;
  }
  LocalBundle Copy() const {
    return CopyLocalBundle(options_, NoiseOptions{}, map_, keyframes_.back());
  }
  BundleResult Solve(LocalBundle& bundle) const {
    return SolveBundle(map_.camera(), bundle.problem, options_.bundle);
  }
  // How far a keyframe is from its true place; the walk began at the truth.
  double Error(KeyFrameId id) const {
    return (map_.PoseOf(id) * world_.Truth(id).Inverse()).translation().norm();
  }
  void Disturb(KeyFrameId id) {
    const Rigid3d off(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.03, 0, 0));
    map_.SetPose(id, off * map_.PoseOf(id));
  }

  TestWorld world_{1};
  Map map_ = world_.EmptyMap();
  MappingOptions options_;
  std::vector<KeyFrameId> keyframes_;
};

TEST_F(LocalBundleTest, TheBestNeighboursMoveAndAllOtherObserversAreFixed) {
  const LocalBundle bundle = Copy();
  ASSERT_EQ(bundle.keyframes.size(), bundle.problem.poses.size());
  EXPECT_EQ(bundle.keyframes[0], keyframes_.back());
  std::vector<KeyFrameId> moving;
  for (size_t k = 0; k < bundle.keyframes.size(); ++k) {
    if (!bundle.problem.poses[k].fixed) moving.push_back(bundle.keyframes[k]);
  }
  EXPECT_EQ(moving.size(), 3u);
  EXPECT_EQ(moving[1], map_.covisibility().Best(keyframes_.back(), 1)[0]);
  EXPECT_EQ(bundle.points, map_.PointsSeenBy(moving));
  size_t num_observations = 0;
  for (const MapPointId id : bundle.points)
    num_observations += map_.FindPoint(id)->observations.size();
  EXPECT_EQ(bundle.problem.observations.size(), num_observations);
}

TEST_F(LocalBundleTest, TheFirstKeyFrameOfTheMapNeverMoves) {
  options_.max_bundle_keyframes = 100;
  map_.StartNewMap();
  const std::vector<KeyFrameId> all =
      world_.Walk(0, 0.25, 0.1, Vector6d::Zero(), TestWorld::PoseOnCircle(0), map_);
  const LocalBundle bundle = CopyLocalBundle(options_, NoiseOptions{}, map_, all.back());
  EXPECT_EQ(bundle.keyframes.size(), all.size());
  for (size_t k = 0; k < bundle.keyframes.size(); ++k)
    EXPECT_EQ(bundle.problem.poses[k].fixed, bundle.keyframes[k] == all.front()) << k;
}

TEST_F(LocalBundleTest, ADisplacedKeyFrameReturns) {
  Disturb(keyframes_.back());
  LocalBundle bundle = Copy();
  const BundleResult result = Solve(bundle);
  ApplyLocalBundle(bundle, result, map_);
  EXPECT_LT(Error(keyframes_.back()), 0.01);
}

TEST_F(LocalBundleTest, AWrongObservationGoes) {
  // The newest keyframe is made to see a point where it shows another one.
  const KeyFrameId newest = keyframes_.back();
  map_.RemovePoint(map_.FindKeyFrame(newest)->points[0]);
  const std::vector<MapPointId> points = map_.PointsSeenBy(std::vector{keyframes_.end()[-2]});
  const auto unseen = std::find_if(points.begin(), points.end(), [&](MapPointId id) {
    return map_.FindPoint(id)->FeatureIn(newest) < 0 && map_.FindPoint(id)->observations.size() > 2;
  });
  ASSERT_NE(unseen, points.end());
  ASSERT_TRUE(map_.AddObservation(*unseen, newest, 0));
  LocalBundle bundle = Copy();
  const BundleResult result = Solve(bundle);
  ApplyLocalBundle(bundle, result, map_);
  ASSERT_NE(map_.FindPoint(*unseen), nullptr);
  EXPECT_LT(map_.FindPoint(*unseen)->FeatureIn(newest), 0);
  EXPECT_FALSE(map_.FindKeyFrame(newest)->points[0].valid());
  EXPECT_LT(Error(newest), 0.02);
}

TEST_F(LocalBundleTest, NothingIsAppliedToAMapThatWasCorrectedMeanwhile) {
  Disturb(keyframes_.back());
  LocalBundle bundle = Copy();
  const BundleResult result = Solve(bundle);
  map_.StartNewEpoch();
  const Rigid3d before = map_.PoseOf(keyframes_.back());
  ApplyLocalBundle(bundle, result, map_);
  EXPECT_EQ(map_.PoseOf(keyframes_.back()).translation(), before.translation());
}

TEST_F(LocalBundleTest, WhatWentWhileItWasSolvedStaysGone) {
  LocalBundle bundle = Copy();
  const BundleResult result = Solve(bundle);
  map_.CullKeyFrame(bundle.keyframes[1]);
  map_.RemovePoint(bundle.points[0]);
  ApplyLocalBundle(bundle, result, map_);
  EXPECT_EQ(map_.FindKeyFrame(bundle.keyframes[1]), nullptr);
  EXPECT_EQ(map_.FindPoint(bundle.points[0]), nullptr);
}

}  // namespace
}  // namespace msf
