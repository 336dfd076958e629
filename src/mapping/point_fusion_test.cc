#include "mapping/point_fusion.h"

#include <gtest/gtest.h>

#include "map/test_world.h"

namespace msf {
namespace {

constexpr double kRadius_px = 3;

class PointFusionTest : public ::testing::Test {
 protected:
  PointFusionTest()
      : first_(world_.AddKeyFrame(TestWorld::PoseOnCircle(0), TestWorld::PoseOnCircle(0), map_)),
        points_(map_.PointsSeenBy(std::vector{first_})) {
    for (const MapPointId id : points_) map_.UpdateNormalAndRange(id);
  }
  // A keyframe a little further on whose place is believed `error_m` off.
  KeyFrameId AddBare(double error_m = 0) {
    const Rigid3d T_cw = TestWorld::PoseOnCircle(0.03);
    const Rigid3d off(Eigen::Quaterniond::Identity(), Eigen::Vector3d(error_m, 0, 0));
    return world_.AddBareKeyFrame(T_cw, off * T_cw, map_);
  }
  std::vector<PointSighting> FindAgain(KeyFrameId keyframe) const {
    return FindPointsAgain(NoiseOptions{}, points_, keyframe, kRadius_px, map_);
  }
  int FuseInto(KeyFrameId keyframe) { return FusePoints(FindAgain(keyframe), keyframe, map_); }
  int LandmarkOf(MapPointId id, KeyFrameId keyframe) const {
    return world_.Landmark(keyframe, map_.FindPoint(id)->FeatureIn(keyframe));
  }

  TestWorld world_{1};
  Map map_ = world_.EmptyMap();
  KeyFrameId first_;
  std::vector<MapPointId> points_;
};

TEST_F(PointFusionTest, PointsAreConnectedWithTheFeaturesThatShowThem) {
  const KeyFrameId second = AddBare();
  const int fused = FuseInto(second);
  EXPECT_GT(fused, 100);
  int connected = 0;
  for (const MapPointId id : points_) {
    if (map_.FindPoint(id)->FeatureIn(second) < 0) continue;
    ++connected;
    EXPECT_EQ(LandmarkOf(id, first_), LandmarkOf(id, second));
  }
  EXPECT_EQ(connected, fused);
  EXPECT_EQ(FuseInto(second), 0) << "they are seen already";
}

TEST_F(PointFusionTest, OfTwoPointsTheBetterObservedStays) {
  const KeyFrameId second = AddBare(), third = AddBare();
  const FrameFeatures& features = *map_.FindKeyFrame(second)->features;
  const Rigid3d T_wc = map_.PoseOf(second).Inverse();
  std::vector<MapPointId> theirs;
  theirs.reserve(features.size());
  for (int i = 0; i < features.size(); ++i) {
    theirs.push_back(map_.AddPoint(T_wc * features.PointInCamera(i, map_.camera()), second, i));
  }
  FuseInto(third);  // the first keyframe's points have two observers
  const int before = map_.NumPoints(map_.active_map());
  const int fused = FuseInto(second);
  EXPECT_GT(fused, 100);
  EXPECT_EQ(map_.NumPoints(map_.active_map()), before - fused);
  int replaced = 0;
  for (const MapPointId id : theirs) {
    if (map_.FindPoint(id)) continue;
    const MapPointId heir = map_.Resolve(id);
    ASSERT_TRUE(heir.valid());
    EXPECT_EQ(LandmarkOf(heir, first_), LandmarkOf(heir, second));
    ++replaced;
  }
  EXPECT_GT(replaced, fused / 2);
}

TEST_F(PointFusionTest, WhatHasGoneSinceItWasFoundIsLeftOut) {
  const KeyFrameId second = AddBare();
  const std::vector<PointSighting> sightings = FindAgain(second);
  ASSERT_GT(sightings.size(), 100u);
  for (size_t k = 0; k < sightings.size() / 2; ++k) map_.RemovePoint(sightings[k].point);
  EXPECT_EQ(FusePoints(sightings, second, map_),
            static_cast<int>(sightings.size() - sightings.size() / 2));
}

TEST_F(PointFusionTest, NothingFitsAKeyFrameAtTheWrongPlace) {
  EXPECT_LT(FuseInto(AddBare(0.3)), 3);
}

}  // namespace
}  // namespace msf
