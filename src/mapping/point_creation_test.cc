#include "mapping/point_creation.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "map/test_world.h"

namespace msf {
namespace {

// Two keyframes side by side that see the same landmarks; the map has none of them yet.
class PointCreationTest : public ::testing::Test {
 protected:
  KeyFrameId Add(double angle_rad) {
    const Rigid3d T_cw = TestWorld::PoseOnCircle(angle_rad);
    return world_.AddBareKeyFrame(T_cw, T_cw, map_);
  }

  TestWorld world_{1};
  Map map_ = world_.EmptyMap();
  const MappingOptions options_{};
};

TEST_F(PointCreationTest, PointsLieWhereTheLandmarksAre) {
  const KeyFrameId a = Add(0), b = Add(0.1);
  const std::vector<NewPoint> points =
      TriangulateWithNeighbour(options_, NoiseOptions{}, map_, b, a);
  ASSERT_GT(points.size(), 100u);
  std::vector<double> errors_m;
  for (const NewPoint& point : points) {
    const int landmark = world_.Landmark(b, point.feature);
    EXPECT_EQ(landmark, world_.Landmark(a, point.neighbour_feature));
    errors_m.push_back((point.p_w - world_.Place(landmark)).norm());
  }
  std::sort(errors_m.begin(), errors_m.end());
  EXPECT_LT(errors_m[errors_m.size() / 2], 0.05);
}

TEST_F(PointCreationTest, KeyFramesAtTheSamePlaceMakeNone) {
  const KeyFrameId a = Add(0), b = Add(0.001);
  EXPECT_TRUE(TriangulateWithNeighbour(options_, NoiseOptions{}, map_, b, a).empty());
}

TEST_F(PointCreationTest, KeyFramesThatAreGoneMakeNone) {
  const KeyFrameId a = Add(0), b = Add(0.1);
  const std::vector<NewPoint> points =
      TriangulateWithNeighbour(options_, NoiseOptions{}, map_, b, a);
  map_.DropMap(map_.active_map());
  EXPECT_TRUE(TriangulateWithNeighbour(options_, NoiseOptions{}, map_, b, a).empty());
  EXPECT_TRUE(AddNewPoints(points, b, a, map_).empty());
}

TEST_F(PointCreationTest, AFeatureGetsOnePointOnly) {
  const KeyFrameId a = Add(0), b = Add(0.1);
  const std::vector<NewPoint> points =
      TriangulateWithNeighbour(options_, NoiseOptions{}, map_, b, a);
  map_.AddPoint({0, 0, 5}, b, points[0].feature);  // taken while the others were computed
  const std::vector<MapPointId> added = AddNewPoints(points, b, a, map_);
  EXPECT_EQ(added.size(), points.size() - 1);
  const MapPoint& first = *map_.FindPoint(added[0]);
  EXPECT_EQ(first.FeatureIn(b), points[1].feature);
  EXPECT_EQ(first.FeatureIn(a), points[1].neighbour_feature);
  EXPECT_GT(first.max_distance_m, first.min_distance_m);
  EXPECT_TRUE(AddNewPoints(points, b, a, map_).empty());
  for (const NewPoint& again : TriangulateWithNeighbour(options_, NoiseOptions{}, map_, b, a))
    EXPECT_FALSE(map_.FindKeyFrame(b)->points[again.feature].valid());
}

}  // namespace
}  // namespace msf
