#include "matching/point_projection.h"

namespace msf {
namespace {

// Slack of the distance range in which a point can still be recognised.
constexpr double kNearSlack = 0.8, kFarSlack = 1.2;

}  // namespace

ViewProjector::ViewProjector(const Rigid3d& T_cw, const Camera& camera, const ScaleLevels& levels,
                             double min_view_cosine)
    : camera_(camera),
      levels_(levels),
      R_cw_(T_cw.RotationMatrix()),
      t_cw_(T_cw.translation()),
      centre_w_(-(R_cw_.transpose() * t_cw_)),
      image_(camera.IdealBounds()),
      min_view_cosine_(min_view_cosine) {}

std::optional<ProjectedPoint> ViewProjector::operator()(const PointSnapshot& point) const {
  const Eigen::Vector3d p_c = R_cw_ * point.p_w + t_cw_;
  if (!(p_c.z() > 0)) return std::nullopt;
  ProjectedPoint projected;
  projected.uv_px = camera_.Project(p_c);
  if (!image_.contains(projected.uv_px)) return std::nullopt;
  const Eigen::Vector3d ray = point.p_w - centre_w_;
  const double distance_m = ray.norm();
  if (distance_m < kNearSlack * point.min_distance_m ||
      distance_m > kFarSlack * point.max_distance_m)
    return std::nullopt;
  projected.view_cosine = ray.dot(point.normal) / distance_m;
  if (projected.view_cosine < min_view_cosine_) return std::nullopt;
  projected.u_right_px = projected.uv_px.x() - camera_.bf / p_c.z();
  projected.level = levels_.Predict(point.max_distance_m / distance_m);
  return projected;
}

}  // namespace msf
