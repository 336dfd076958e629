// A piece of the map as a bundle adjustment problem, and its solution as a correction.
#pragma once

#include <span>
#include <vector>

#include "loop_closing/map_correction.h"
#include "optimization/bundle_adjustment.h"
#include "optimization/feature_observation.h"

namespace msf {

struct MapBundle {
  BundleProblem problem;
  std::vector<KeyFrameId> keyframes;        // of problem.poses: free ones, then fixed ones
  std::vector<MapPointId> points;           // of problem.points
  std::vector<Rigid3d> T_cw_before;         // of the keyframes when copied
  std::vector<Eigen::Vector3d> p_w_before;  // of the points when copied
  MapId map_id;
  uint64_t epoch = 0;
};

// The poses of `free` may move, those of `fixed` may not; all points that a free keyframe sees may.
// Only these keyframes' observations take part. All must be keyframes of one map.
MapBundle CopyBundle(const Map& map, const NoiseOptions& noise, std::span<const KeyFrameId> free,
                     std::span<const KeyFrameId> fixed);

// What the solved problem says about how the map moves; fixed keyframes do not.
MapCorrection CorrectionOf(const MapBundle& bundle);

}  // namespace msf
