// A walk through the test world with a camera that has gone one step further, for the tests of
// tracking.
#pragma once

#include "map/test_world.h"
#include "tracking/pose_tracking.h"

namespace msf {

class TrackedWorld {
 public:
  TrackedWorld()
      : keyframes(world.Walk(0, 0.25, 0.05, Vector6d::Zero(), TestWorld::PoseOnCircle(0), map)),
        view(world.Look(T_cw_true)) {
    for (const MapPointId id : map.PointsSeenBy(keyframes)) map.UpdateNormalAndRange(id);
  }

  // The newest keyframe as a frame that was tracked.
  Frame LastFrame() const {
    const KeyFrame& keyframe = *map.FindKeyFrame(keyframes.back());
    Frame frame;
    frame.features = keyframe.features;
    frame.words = keyframe.words;
    frame.T_cw = keyframe.T_cw;
    frame.points = keyframe.points;
    return frame;
  }
  // Share of the matches whose point shows the same landmark as their feature.
  double RightShare(const std::vector<PointMatch>& matches) const {
    int right = 0;
    for (const PointMatch& match : matches) {
      const Observation& seen = map.FindPoint(match.point)->observations.front();
      right += world.Landmark(seen.keyframe, seen.feature) == view.landmarks[match.feature];
    }
    return matches.empty() ? 0 : static_cast<double>(right) / static_cast<double>(matches.size());
  }
  double PoseError(const Rigid3d& T_cw) const { return (T_cw * T_cw_true.Inverse()).Log().norm(); }

  TestWorld world{1};
  Map map = world.EmptyMap();
  std::vector<KeyFrameId> keyframes;
  const Rigid3d T_cw_true = TestWorld::PoseOnCircle(0.28);
  TestWorld::View view;  // what the camera sees now
  const TrackingOptions options;
  const NoiseOptions noise;
  const TrackingContext context{map.camera(), map.levels(), options, noise};
};

}  // namespace msf
