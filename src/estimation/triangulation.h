// Two views of one point: where it is, how well they fix it, and whether they can belong together.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "geometry/rigid3d.h"
#include "sensor/camera.h"

namespace msf {

// The world point that projects nearest to both undistorted pixels, by linear least squares of the
// projection equations (direct linear transform in inhomogeneous form; Hartley & Sturm,
// Triangulation, 1997). Nothing when the rays are parallel or the point would lie behind one of the
// cameras.
std::optional<Eigen::Vector3d> Triangulate(const Camera& camera, const Rigid3d& T_1w,
                                           const Eigen::Vector2d& uv1_px, const Rigid3d& T_2w,
                                           const Eigen::Vector2d& uv2_px);

// Cosine of the angle between the two viewing rays; 1 = no parallax.
double CosParallax(const Camera& camera, const Rigid3d& T_1w, const Eigen::Vector2d& uv1_px,
                   const Rigid3d& T_2w, const Eigen::Vector2d& uv2_px);

// F with (u2, v2, 1) F (u1, v1, 1)^T = 0 for the undistorted pixels of one point.
Eigen::Matrix3d FundamentalMatrix(const Camera& camera, const Rigid3d& T_1w, const Rigid3d& T_2w);

// Squared distance of pixel 2 from the epipolar line of pixel 1, px^2; infinite when there is no
// such line (no baseline).
double EpipolarDistance2(const Eigen::Matrix3d& F, const Eigen::Vector2d& uv1_px,
                         const Eigen::Vector2d& uv2_px);

}  // namespace msf
