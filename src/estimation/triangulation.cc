#include "estimation/triangulation.h"

#include <Eigen/QR>

namespace msf {
namespace {

// Rays that differ by less than this do not meet anywhere useful, rad.
constexpr double kMinAngle = 1e-6;

}  // namespace

std::optional<Eigen::Vector3d> Triangulate(const Camera& camera, const Rigid3d& T_1w,
                                           const Eigen::Vector2d& uv1_px, const Rigid3d& T_2w,
                                           const Eigen::Vector2d& uv2_px) {
  // In camera 1: x - x1 z = 0 and y - y1 z = 0; the same in camera 2 for R p + t.
  const Rigid3d T_21 = T_2w * T_1w.Inverse();
  const Eigen::Matrix3d R_21 = T_21.RotationMatrix();
  const Eigen::Vector3d ray1 = camera.Unproject(uv1_px, 1), ray2 = camera.Unproject(uv2_px, 1);
  if (!((R_21 * ray1).cross(ray2).norm() > kMinAngle * ray1.norm() * ray2.norm()))
    return std::nullopt;
  Eigen::Matrix<double, 4, 3> equations;
  equations.row(0) << 1, 0, -ray1.x();
  equations.row(1) << 0, 1, -ray1.y();
  equations.row(2) = R_21.row(0) - ray2.x() * R_21.row(2);
  equations.row(3) = R_21.row(1) - ray2.y() * R_21.row(2);
  const Eigen::Vector3d& t = T_21.translation();
  const Eigen::Vector4d right_side(0, 0, ray2.x() * t.z() - t.x(), ray2.y() * t.z() - t.y());
  const Eigen::Vector3d p_1 = equations.householderQr().solve(right_side);
  if (!p_1.allFinite() || !(p_1.z() > 0) || !((T_21 * p_1).z() > 0)) return std::nullopt;
  return T_1w.Inverse() * p_1;
}

}  // namespace msf
