// The relative pose of two cameras from points that both know in 3D, some of the matches wrong.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "estimation/ransac.h"
#include "geometry/rigid3d.h"
#include "sensor/camera.h"

namespace msf {

// One world point as two cameras (or two maps) hold it.
struct RigidMatch {
  Eigen::Vector3d p_c1 = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_c2 = Eigen::Vector3d::Zero();
  double sigma2_1_px2 =
      1;  // variance of its position in the image of camera 1: that of its pyramid level
  double sigma2_2_px2 = 1;
};

struct RigidAlignmentOptions {
  RansacOptions ransac{.min_inliers = 15};
  double chi2 = 9.21;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("ransac", ransac, "sampling");
    visit("chi2", chi2, "inlier gate on squared reprojection error over variance, in either image");
  }
  Status Check() const;
};

struct RigidAlignment {
  Rigid3d T_c1_c2;              // p_c1 = T_c1_c2 * p_c2
  std::vector<uint8_t> inlier;  // per match
  int num_inliers = 0;
};

// RANSAC over alignments of three points with the scale fixed, refined on the inliers. A match is
// an inlier when each camera's point, brought into the other camera, projects within the gate of
// the other's own point there. Nothing when no motion has options.ransac.min_inliers. Deterministic
// for equal seeds.
std::optional<RigidAlignment> AlignRigidly(const Camera& camera,
                                           std::span<const RigidMatch> matches,
                                           const RigidAlignmentOptions& options);

}  // namespace msf
