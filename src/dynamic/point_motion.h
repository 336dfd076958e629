// Does a point move by itself? Its flow and depth against what the camera's motion alone would do
// to it.
#pragma once

#include <span>
#include <vector>

#include "dynamic/coarse_depth.h"
#include "dynamic/dynamic_options.h"
#include "feature/frame_features.h"
#include "feature/scale_levels.h"
#include "flow/point_flow.h"
#include "geometry/rigid3d.h"

namespace msf {

// An older image, as the tests need it.
struct PastView {
  FrameId frame;
  double time_s = 0;
  FlowImage image;
  CoarseDepth depth;
  Rigid3d T_past_now;  // takes coordinates of the camera now to those of then
  Vector6d unsteadiness =
      Vector6d::Zero();  // change of the camera's motion (twist per frame) up to now
};

enum class PointMotion : uint8_t {
  kUntested,  // not found in the other image, or no verdict possible
  kStatic,
  kMovesSideways,  // its flow disagrees
  kMovesInDepth,   // its depth does
};
inline bool Moves(PointMotion motion) {
  return motion == PointMotion::kMovesSideways || motion == PointMotion::kMovesInDepth;
}

// Where features of this frame would be in the past image if they stood still; for those without
// depth: at infinity.
std::vector<Eigen::Vector2f> PredictInPast(const Camera& camera, const FrameFeatures& features,
                                           std::span<const int> which, const Rigid3d& T_past_now);

// Points to be tested: features, their places in the past image, and whether each lies on an object
// (the others tell how noisy the image is; where there are few of them it counts as usual).
struct MotionTestPoints {
  std::vector<int> which;
  std::vector<FlowPoint> flow;
  std::vector<uint8_t> on_object;
};

// A verdict on each point.
std::vector<PointMotion> TestMotion(const Camera& camera, const ScaleLevels& levels,
                                    const FrameFeatures& features, const MotionTestPoints& points,
                                    const PastView& past, const MotionTestOptions& options);

}  // namespace msf
