#include "tracking/camera_roll.h"

#include <Eigen/LU>
#include <cmath>

namespace msf {
namespace {

// Of all x axes, where they speak against the mean y axis.
constexpr double kTrustInMeanY = 0.1;
constexpr double kLeastRoll_rad = M_PI / 4;
// Sine of the angle between viewing direction and vertical below which nothing is upright.
constexpr double kLeastLevel = 0.2;
// As many poses what was learnt in another world is worth, since the camera has moved in between.
constexpr double kMostMoved = 100;

}  // namespace

CameraRoll::CameraRoll(double mounted_rad)
    : x_c_(std::cos(mounted_rad), -std::sin(mounted_rad), 0),
      y_c_(std::sin(mounted_rad), std::cos(mounted_rad), 0),
      down_c_(y_c_) {}

void CameraRoll::Add(const Rigid3d& T_cw, bool same_world) {
  const Eigen::Matrix3d R_wc = T_cw.RotationMatrix().transpose();
  if (!same_world) MoveTo(R_wc);
  R_wc_ = R_wc;
  const Eigen::Vector3d x_w = R_wc * x_c_;
  sum_xx_ += x_w * x_w.transpose();
  sum_y_ += R_wc * y_c_;
  ++num_poses_;
  // Minimises the mean of (x . down)^2 + trust |down - mean y|^2.
  const Eigen::Matrix3d weights =
      sum_xx_ / num_poses_ + kTrustInMeanY * Eigen::Matrix3d::Identity();
  const Eigen::Vector3d down_w = (weights.inverse() * sum_y_).normalized();
  down_c_ = R_wc.transpose() * down_w;
}

// To a world in which the last camera has the orientation `R_wc`.
void CameraRoll::MoveTo(const Eigen::Matrix3d& R_wc) {
  const Eigen::Matrix3d R_new_old = R_wc * R_wc_.transpose();
  const double share = num_poses_ > kMostMoved ? kMostMoved / num_poses_ : 1;
  sum_xx_ = share * R_new_old * sum_xx_ * R_new_old.transpose();
  sum_y_ = share * R_new_old * sum_y_;
  num_poses_ *= share;
}

double CameraRoll::TurnUpright_rad() const {
  if (std::hypot(down_c_.x(), down_c_.y()) < kLeastLevel) return 0;
  const double roll = std::atan2(down_c_.x(), down_c_.y());
  return std::abs(roll) < kLeastRoll_rad ? 0 : roll;
}

}  // namespace msf
