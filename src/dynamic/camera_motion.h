// How the camera moved between two images, from the points that stand still.
#pragma once

#include <span>

#include "dynamic/point_motion.h"
#include "feature/landmark.h"
#include "optimization/pose_optimizer.h"

namespace msf {

struct CameraMotion {
  Rigid3d T_past_now;
  int num_points = 0;  // with depth and flow
  int num_inliers = 0;
  // Enough points agree: else T_past_now is the prediction.
  bool reliable = false;
};

// Refines `T_past_now_predicted` so that the features `which` (with depth) project to where `flow`
// found them in the past image: robust pose optimisation; where fewer than half of the points agree
// with it, RANSAC (seeded) first.
CameraMotion EstimateCameraMotion(const Camera& camera, const ScaleLevels& levels,
                                  const FrameFeatures& features, std::span<const int> which,
                                  std::span<const FlowPoint> flow,
                                  const Rigid3d& T_past_now_predicted, uint64_t seed);

// The same from what the past image showed of the map's trusted part: `flow` says where the
// landmarks are now. Reliable where at least 12 were found and most of them agree.
CameraMotion EstimateCameraMotion(const Camera& camera, std::span<const Landmark> landmarks,
                                  std::span<const FlowPoint> flow,
                                  const Rigid3d& T_past_now_predicted, uint64_t seed);

}  // namespace msf
