#include "tracking/trajectory_recorder.h"

#include <gtest/gtest.h>

namespace msf {
namespace {

KeyFrame EmptyKeyFrame(const Rigid3d& T_cw) {
  KeyFrame keyframe;
  keyframe.features = std::make_shared<const FrameFeatures>();
  keyframe.T_cw = T_cw;
  return keyframe;
}

Rigid3d Shift(double x_m) { return {Eigen::Quaterniond::Identity(), Eigen::Vector3d(x_m, 0, 0)}; }

class TrajectoryRecorderTest : public testing::Test {
 protected:
  TrajectoryRecorderTest()
      : map_(std::make_shared<const Camera>(*Camera::Preset("simulated")), ScaleLevels(8, 1.2)) {
    map_.StartNewMap();
  }
  KeyFrameId Add(const Rigid3d& T_cw) {
    const KeyFrameId id = map_.AddKeyFrame(EmptyKeyFrame(T_cw));
    map_.UpdateConnections(id);
    return id;
  }
  TrackingResult Tracked(KeyFrameId reference, const Rigid3d& T_c_reference) {
    TrackingResult result;
    result.state = TrackingState::kTracking;
    result.T_cw = T_c_reference * map_.PoseOf(reference);
    result.reference = reference;
    result.T_c_reference = T_c_reference;
    return result;
  }
  Map map_;
  TrajectoryRecorder recorder_;
};

TEST_F(TrajectoryRecorderTest, FramesFollowTheirKeyFrameThroughCorrections) {
  const KeyFrameId id = Add(Shift(1));
  recorder_.Record(Tracked(id, Shift(0.5)));
  map_.SetPose(id, Shift(3));
  const std::vector<ResolvedFrame> frames = recorder_.Resolve(map_);
  ASSERT_TRUE(frames[0].T_wc.has_value());
  EXPECT_NEAR(frames[0].T_wc->translation().x(), -3.5, 1e-12);
}

TEST_F(TrajectoryRecorderTest, ACulledKeyFrameMovesWithItsHeir) {
  const KeyFrameId root = Add(Shift(0));
  const KeyFrameId id = Add(Shift(1));
  map_.SetParent(id, root);
  recorder_.Record(Tracked(id, Shift(0.5)));
  map_.CullKeyFrame(id);
  map_.SetPose(root, Shift(10));
  EXPECT_NEAR(recorder_.Resolve(map_)[0].T_wc->translation().x(), -11.5, 1e-12);
}

TEST_F(TrajectoryRecorderTest, LostFramesAndForgottenMapsHaveNoPose) {
  const KeyFrameId id = Add(Shift(0));
  recorder_.Record(Tracked(id, Shift(0)));
  TrackingResult lost;
  lost.state = TrackingState::kRecentlyLost;
  recorder_.Record(lost);
  map_.DropMap(map_.active_map());
  for (const ResolvedFrame& frame : recorder_.Resolve(map_)) EXPECT_FALSE(frame.T_wc.has_value());
}

}  // namespace
}  // namespace msf
