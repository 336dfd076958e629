#include "tracking/local_map.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tracking/test_frame.h"

namespace msf {
namespace {

constexpr int kMaxKeyFrames = 80;
constexpr int kMaxNeighbours = 10;

class LocalMapTest : public ::testing::Test {
 protected:
  void Update(const Frame& frame, int max_keyframes = kMaxKeyFrames) {
    local_.Update(at_.map, frame, max_keyframes, kMaxNeighbours);
  }
  std::vector<MapPointId> PointIds() const {
    std::vector<MapPointId> ids;
    for (const PointSnapshot& point : local_.points()) ids.push_back(point.id);
    return ids;
  }

  TrackedWorld at_;
  LocalMap local_;
};

TEST_F(LocalMapTest, HoldsAllPointsOfTheKeyFramesAround) {
  Update(at_.LastFrame());
  EXPECT_EQ(local_.best_keyframe(), at_.keyframes.back());
  EXPECT_GE(local_.keyframes().size(), 3u);
  EXPECT_EQ(PointIds(), at_.map.PointsSeenBy(local_.keyframes()));
}

TEST_F(LocalMapTest, NeighboursAreAddedUpToTheLimit) {
  Frame frame = at_.LastFrame();
  // Only points that nobody but the newest keyframe shows: the others come in as neighbours.
  for (MapPointId& id : frame.points) {
    if (id.valid() && at_.map.FindPoint(id)->observations.size() > 1) id = MapPointId();
  }
  ASSERT_GT(frame.NumPoints(), 0);
  Update(frame, 1);
  EXPECT_EQ(local_.keyframes(), std::vector{at_.keyframes.back()});
  Update(frame);
  EXPECT_GT(local_.keyframes().size(), 1u);
}

TEST_F(LocalMapTest, OfManyKeyFramesThoseThatShareMostPointsAreTaken) {
  Update(at_.LastFrame());
  ASSERT_GT(local_.keyframes().size(), 2u);
  Update(at_.LastFrame(), 2);
  EXPECT_EQ(local_.keyframes().size(), 2u);
  EXPECT_EQ(local_.best_keyframe(), at_.keyframes.back());
}

TEST_F(LocalMapTest, KnowsWhenAPointIsDoubted) {
  const Frame frame = at_.LastFrame();
  Update(frame);
  at_.map.ObserveStaticProbability(local_.points().front().id, 0);
  Update(frame);
  EXPECT_LT(local_.points().front().static_weight, 1);
}

TEST_F(LocalMapTest, FollowsTheMap) {
  const Frame frame = at_.LastFrame();
  Update(frame);
  const MapPointId moved = local_.points().front().id, removed = local_.points().back().id;
  at_.map.SetPosition(moved, {7, 8, 9});
  at_.map.RemovePoint(removed);
  Update(frame);
  EXPECT_EQ(local_.points().front().p_w, Eigen::Vector3d(7, 8, 9));
  const std::vector<MapPointId> ids = PointIds();
  EXPECT_FALSE(std::binary_search(ids.begin(), ids.end(), removed));
}

TEST_F(LocalMapTest, AFrameWithoutPointsKeepsTheNeighbourhood) {
  Update(at_.LastFrame());
  const size_t num_points = local_.points().size();
  Frame lost = at_.LastFrame();
  lost.points.assign(lost.points.size(), MapPointId());
  Update(lost);
  EXPECT_EQ(local_.points().size(), num_points);
  EXPECT_FALSE(local_.best_keyframe().valid());
  local_.Clear();
  EXPECT_TRUE(local_.points().empty());
}

}  // namespace
}  // namespace msf
