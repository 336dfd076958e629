// The first frame of a map, or after tracking was lost: a rolling shutter bends it, and there was
// no velocity yet to undo that by.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "tracking/pose_tracking.h"

namespace msf {

struct FirstFrame {
  std::shared_ptr<const FrameFeatures> features;  // a rolling shutter undone
  Rigid3d T_cw;
  std::vector<PointMatch> matches;  // with `points`, also those that do not agree with the pose
};

// The frame with `features` as extracted and the pose `T_cw` as tracked, once the pose of the next
// one is known, `interval_s` later. In turn its velocity comes from the two poses and its pose from
// the features that the velocity straightens: for a map that has seen the place from other frames
// as well. `points`: of the map around it; when too few of them agree the pose is kept. Empty where
// the camera was so slow that much of what is undone would be noise of its velocity.
std::optional<FirstFrame> SettleFirstFrame(const TrackingContext& context,
                                           const std::vector<PointSnapshot>& points,
                                           const FrameFeatures& features, const Rigid3d& T_cw,
                                           const Rigid3d& T_cw_next, double interval_s);

}  // namespace msf
