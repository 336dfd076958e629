#include "loop_closing/map_correction.h"

#include <gtest/gtest.h>

#include "loop_closing/map_bundle.h"
#include "loop_closing/map_pose_graph.h"
#include "map/test_world.h"

namespace msf {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

class MapCorrectionTest : public ::testing::Test {
 protected:
  MapCorrectionTest()
      : keyframes_(world_.Walk(0, 30 * kDegree, 6 * kDegree, Vector6d::Zero(),
                               TestWorld::PoseOnCircle(0), map_)) {
    Vector6d twist;
    twist << 0.1, 0.2, 0.3, 0.03, 0.02, 0.01;
    motion_ = Rigid3d::Exp(twist);
  }
  // How far what the keyframe sees is from where it saw it, over all its points, px.
  double WorstReprojection(KeyFrameId id) const {
    const KeyFrame& keyframe = *map_.FindKeyFrame(id);
    double worst_px = 0;
    for (size_t i = 0; i < keyframe.points.size(); ++i) {
      const MapPoint* point = map_.FindPoint(keyframe.points[i]);
      if (!point) continue;
      const Eigen::Vector2d uv_px = map_.camera().Project(keyframe.T_cw * point->p_w);
      worst_px = std::max(worst_px, (uv_px - keyframe.features->uv_px[i].cast<double>()).norm());
    }
    return worst_px;
  }
  MapCorrection MoveAll() const {
    MapCorrection correction{MapId(0), map_.epoch(), {}, {}};
    for (const KeyFrameId id : keyframes_) correction.motion[id] = motion_;
    return correction;
  }

  TestWorld world_{1};
  Map map_ = world_.EmptyMap();
  const std::vector<KeyFrameId> keyframes_;
  Rigid3d motion_;
};

TEST_F(MapCorrectionTest, MovesKeyFramesAndPointsTogether) {
  const double before_px = WorstReprojection(keyframes_[2]);
  const Rigid3d T_cw_before = map_.PoseOf(keyframes_[2]);
  ASSERT_TRUE(ApplyCorrection(MoveAll(), map_));
  EXPECT_NEAR(WorstReprojection(keyframes_[2]), before_px, 1e-6);
  const Rigid3d moved = MotionBetween(T_cw_before, map_.PoseOf(keyframes_[2]));
  EXPECT_LT((moved * motion_.Inverse()).Log().norm(), 1e-9);
}

TEST_F(MapCorrectionTest, WhatJoinedMeanwhileMovesAlong) {
  const MapCorrection correction = MoveAll();
  const Rigid3d truth = TestWorld::PoseOnCircle(36 * kDegree);
  const KeyFrameId late = world_.AddKeyFrame(truth, truth, map_);
  const double before_px = WorstReprojection(late);
  const Rigid3d T_late_last = map_.PoseOf(late) * map_.PoseOf(keyframes_.back()).Inverse();
  ASSERT_TRUE(ApplyCorrection(correction, map_));
  const Rigid3d T_late_last_after = map_.PoseOf(late) * map_.PoseOf(keyframes_.back()).Inverse();
  EXPECT_LT((T_late_last_after * T_late_last.Inverse()).Log().norm(), 1e-9);
  EXPECT_NEAR(WorstReprojection(late), before_px, 1e-6);
}

TEST_F(MapCorrectionTest, CulledKeyFramesMoveWithTheirHeirs) {
  const MapCorrection correction = MoveAll();
  map_.CullKeyFrame(keyframes_[3]);
  const Rigid3d before = map_.PoseOf(keyframes_[3]);
  ASSERT_TRUE(ApplyCorrection(correction, map_));
  const Rigid3d moved = MotionBetween(before, map_.PoseOf(keyframes_[3]));
  EXPECT_LT((moved * motion_.Inverse()).Log().norm(), 1e-9);
}

TEST_F(MapCorrectionTest, ASecondCorrectionOfTheSameCopyIsRefused) {
  const MapCorrection correction = MoveAll();
  ASSERT_TRUE(ApplyCorrection(correction, map_));
  const Rigid3d T_cw = map_.PoseOf(keyframes_[1]);
  EXPECT_FALSE(ApplyCorrection(correction, map_));
  EXPECT_EQ(map_.PoseOf(keyframes_[1]).translation(), T_cw.translation());
}

TEST_F(MapCorrectionTest, OtherMapsStay) {
  map_.StartNewMap();
  const auto others = world_.Walk(0, 12 * kDegree, 6 * kDegree, Vector6d::Zero(), Rigid3d(), map_);
  const Rigid3d T_cw = map_.PoseOf(others[1]);
  ASSERT_TRUE(ApplyCorrection(MoveAll(), map_));
  EXPECT_EQ(map_.PoseOf(others[1]).translation(), T_cw.translation());
}

TEST_F(MapCorrectionTest, SolvedPointsGoWhereTheyWereSolvedUnlessTheyMovedMeanwhile) {
  MapCorrection correction = MoveAll();
  const std::vector<MapPointId> points = map_.PointIds(MapId(0));
  const Eigen::Vector3d goal(1, 2, 9);
  correction.points.push_back({points[0], map_.FindPoint(points[0])->p_w, goal});
  correction.points.push_back({points[1], map_.FindPoint(points[1])->p_w, goal});
  const Eigen::Vector3d refined = map_.FindPoint(points[1])->p_w + Eigen::Vector3d(0.01, 0, 0);
  map_.SetPosition(points[1], refined);
  ASSERT_TRUE(ApplyCorrection(correction, map_));
  EXPECT_EQ(map_.FindPoint(points[0])->p_w, goal);
  EXPECT_LT((map_.FindPoint(points[1])->p_w - motion_ * refined).norm(), 1e-9);
}

TEST_F(MapCorrectionTest, APoseGraphOfAConsistentMapMovesNothing) {
  MapPoseGraph copy = CopyPoseGraph(map_, keyframes_, 100);
  EXPECT_EQ(copy.graph.nodes.size(), keyframes_.size());
  EXPECT_TRUE(copy.graph.nodes[0].fixed);
  EXPECT_GE(copy.graph.edges.size(), keyframes_.size() - 1);
  const size_t num_edges = copy.graph.edges.size();
  copy.AddEdge(keyframes_[0], KeyFrameId(99), Rigid3d());
  EXPECT_EQ(copy.graph.edges.size(), num_edges) << "an edge to a keyframe that is not there";
  ASSERT_TRUE(SolvePoseGraph(copy.graph, {}).usable);
  for (const auto& [id, motion] : CorrectionOf(copy).motion) EXPECT_LT(motion.Log().norm(), 1e-6);
}

TEST_F(MapCorrectionTest, ABundleHoldsOnlyTheChosenKeyFrames) {
  const std::vector<KeyFrameId> free = {keyframes_[2], keyframes_[3]}, fixed = {keyframes_[1]};
  const MapBundle bundle = CopyBundle(map_, {}, free, fixed);
  EXPECT_EQ(bundle.keyframes,
            (std::vector<KeyFrameId>{keyframes_[2], keyframes_[3], keyframes_[1]}));
  EXPECT_FALSE(bundle.problem.poses[1].fixed);
  EXPECT_TRUE(bundle.problem.poses[2].fixed);
  for (const MapPointId id : bundle.points) {
    const MapPoint& point = *map_.FindPoint(id);
    EXPECT_TRUE(point.FeatureIn(keyframes_[2]) >= 0 || point.FeatureIn(keyframes_[3]) >= 0);
  }
  const MapCorrection correction = CorrectionOf(bundle);
  EXPECT_EQ(correction.motion.size(), 3u);
  EXPECT_EQ(correction.points.size(), bundle.points.size());
}

}  // namespace
}  // namespace msf
