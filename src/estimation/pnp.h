// The pose of a camera from matches of world points with pixels, some of them wrong.
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

struct PnpMatch {
  Eigen::Vector3d p_w = Eigen::Vector3d::Zero();
  Eigen::Vector2d uv_px = Eigen::Vector2d::Zero();  // undistorted
  double sigma2_px2 = 1;                            // variance of u and of v
};

struct PnpOptions {
  RansacOptions ransac;
  double chi2 = 5.991;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("ransac", ransac, "sampling");
    visit("chi2", chi2, "inlier gate on squared reprojection error over variance");
  }
  Status Check() const;
};

struct PnpEstimate {
  Rigid3d T_cw;
  std::vector<uint8_t> inlier;  // per match
  int num_inliers = 0;
};

// RANSAC over three-point poses (Ke & Roumeliotis, An Efficient Algebraic Solution to P3P, 2017),
// refined on the inliers. Nothing when no pose has options.ransac.min_inliers. Deterministic for
// equal seeds. Matches that are not finite are outliers.
std::optional<PnpEstimate> EstimatePose(const Camera& camera, std::span<const PnpMatch> matches,
                                        const PnpOptions& options);

}  // namespace msf
