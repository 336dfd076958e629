// Two views of one point: where it is.
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

}  // namespace msf
