#include "mapping/point_culling.h"

#include <gtest/gtest.h>

#include "map/test_world.h"

namespace msf {
namespace {

class PointCullingTest : public ::testing::Test {
 protected:
  KeyFrameId Add() { return world_.AddBareKeyFrame(Rigid3d(), Rigid3d(), map_); }
  MapPointId AddYoungPoint(KeyFrameId keyframe, int feature) {
    const MapPointId id = map_.AddPoint({0, 0, 5}, keyframe, feature);
    young_.Add(id);
    return id;
  }

  TestWorld world_{1};
  Map map_ = world_.EmptyMap();
  RecentPoints young_;
  const MappingOptions options_{};
};

TEST_F(PointCullingTest, PointsThatAreRarelyFoundGo) {
  const KeyFrameId first = Add();
  const MapPointId found = AddYoungPoint(first, 0), missed = AddYoungPoint(first, 1);
  for (const MapPointId id : {found, missed}) map_.CountVisible(id, 9);
  map_.CountFound(found, 2);
  young_.Cull(options_, first, map_);
  EXPECT_NE(map_.FindPoint(found), nullptr);   // 3 of 10
  EXPECT_EQ(map_.FindPoint(missed), nullptr);  // 1 of 10
}

TEST_F(PointCullingTest, PointsThatNobodyElseSawGoAfterTwoKeyFrames) {
  const KeyFrameId first = Add(), second = Add();
  const MapPointId alone = AddYoungPoint(first, 0), shared = AddYoungPoint(first, 1);
  map_.AddObservation(shared, second, 1);
  young_.Cull(options_, second, map_);
  EXPECT_NE(map_.FindPoint(alone), nullptr);
  young_.Cull(options_, Add(), map_);
  EXPECT_EQ(map_.FindPoint(alone), nullptr);
  EXPECT_NE(map_.FindPoint(shared), nullptr);
}

TEST_F(PointCullingTest, EstablishedPointsAreNoLongerJudged) {
  const KeyFrameId first = Add(), second = Add();
  const MapPointId point = AddYoungPoint(first, 0);
  map_.AddObservation(point, second, 0);
  Add();
  young_.Cull(options_, Add(), map_);
  map_.CountVisible(point, 100);
  young_.Cull(options_, Add(), map_);
  EXPECT_NE(map_.FindPoint(point), nullptr);
}

TEST_F(PointCullingTest, PointsThatWentMeanwhileAreForgotten) {
  const KeyFrameId first = Add();
  map_.RemovePoint(AddYoungPoint(first, 0));
  young_.Cull(options_, first, map_);
  EXPECT_EQ(map_.NumPoints(map_.active_map()), 0);
}

TEST_F(PointCullingTest, PointsThatTurnOutToMoveGo) {
  const KeyFrameId first = Add(), second = Add();
  const MapPointId moving = AddYoungPoint(first, 0), still = AddYoungPoint(first, 1);
  for (const MapPointId id : {moving, still}) map_.AddObservation(id, second, id == moving ? 0 : 1);
  EXPECT_EQ(CullMovingPoints(options_, second, map_), 0);
  for (int i = 0; i < 15; ++i) map_.ObserveStaticProbability(moving, 0.05f);
  map_.ObserveStaticProbability(still, 0.05f);
  EXPECT_EQ(CullMovingPoints(options_, second, map_), 1);
  EXPECT_EQ(map_.FindPoint(moving), nullptr);
  EXPECT_NE(map_.FindPoint(still), nullptr);
}

}  // namespace
}  // namespace msf
