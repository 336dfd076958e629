// Points that move together outside all known objects: movers of unknown class.
#pragma once

#include <vector>

#include "dynamic/point_motion.h"

namespace msf {

// What is known of a point that was tested.
struct TestedPoint {
  Eigen::Vector2f image_px;
  float depth_m = 0;  // 0 = none
  bool moves = false;
};

// Groups of points that move, indices into `points`: neighbours are closer than
// `options.cluster_px` and, where both have depth, similar in it. At least
// `options.min_cluster_points` in a group, and within its extent and depth most tested points move.
std::vector<std::vector<int>> FindMovingClusters(const std::vector<TestedPoint>& points,
                                                 const ObjectTrackOptions& options);

}  // namespace msf
