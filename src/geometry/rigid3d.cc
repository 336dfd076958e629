#include "geometry/rigid3d.h"

#include <cmath>

namespace msf {
namespace {

constexpr double kSmallAngle = 1e-8;

// V of Exp((v, w)) = (exp(w), V v); see Barfoot, State Estimation for Robotics, eq. 7.37 (left
// Jacobian of SO(3)).
Eigen::Matrix3d LeftJacobian(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  const Eigen::Matrix3d hat = Hat(w);
  if (angle < kSmallAngle) return Eigen::Matrix3d::Identity() + 0.5 * hat;
  const double angle2 = angle * angle;
  return Eigen::Matrix3d::Identity() + (1 - std::cos(angle)) / angle2 * hat +
         (angle - std::sin(angle)) / (angle2 * angle) * hat * hat;
}

}  // namespace

Eigen::Matrix3d Hat(const Eigen::Vector3d& v) {
  Eigen::Matrix3d hat;
  hat << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return hat;
}

Eigen::Quaterniond ExpRotation(const Eigen::Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  const double scale = angle < kSmallAngle ? 0.5 : std::sin(0.5 * angle) / angle;
  const Eigen::Vector3d v = scale * rotation_vector;
  return Eigen::Quaterniond(std::cos(0.5 * angle), v.x(), v.y(), v.z()).normalized();
}

Eigen::Vector3d LogRotation(const Eigen::Quaterniond& rotation) {
  const double sign = rotation.w() < 0 ? -1 : 1;
  const double sine = rotation.vec().norm();
  if (sine < kSmallAngle) return 2 * sign * rotation.vec();
  return 2 * std::atan2(sine, sign * rotation.w()) / sine * sign * rotation.vec();
}

double Rigid3d::Angle() const {
  return 2 * std::atan2(rotation_.vec().norm(), std::abs(rotation_.w()));
}

Rigid3d Rigid3d::Exp(const Vector6d& twist) {
  const Eigen::Vector3d w = twist.tail<3>();
  return {ExpRotation(w), LeftJacobian(w) * twist.head<3>()};
}

Vector6d Rigid3d::Log() const {
  const Eigen::Vector3d w = LogRotation(rotation_);
  Vector6d twist;
  twist.head<3>() = LeftJacobian(w).partialPivLu().solve(translation_);
  twist.tail<3>() = w;
  return twist;
}

}  // namespace msf
