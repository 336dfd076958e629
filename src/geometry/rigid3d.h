// Rigid motions of space, SE(3). Naming: T_cw takes world coordinates to camera coordinates, p_c =
// T_cw * p_w.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace msf {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

// The matrix of the cross product: Hat(a) * b = a x b.
Eigen::Matrix3d Hat(const Eigen::Vector3d& v);

class Rigid3d {
 public:
  Rigid3d() = default;
  // `rotation` is normalised.
  Rigid3d(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation)
      : rotation_(rotation.normalized()), translation_(translation) {}
  Rigid3d(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation)
      : Rigid3d(Eigen::Quaterniond(rotation), translation) {}

  const Eigen::Quaterniond& rotation() const { return rotation_; }
  const Eigen::Vector3d& translation() const { return translation_; }
  Eigen::Matrix3d RotationMatrix() const { return rotation_.toRotationMatrix(); }

  Rigid3d Inverse() const {
    const Eigen::Quaterniond inverse = rotation_.conjugate();
    return {inverse, -(inverse * translation_)};
  }
  // The angle of the rotation, [0, pi] rad.
  double Angle() const;

  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const {
    return rotation_ * point + translation_;
  }
  Rigid3d operator*(const Rigid3d& other) const {
    return {rotation_ * other.rotation_, rotation_ * other.translation_ + translation_};
  }

  // The motion of the twist (translation part first, then rotation vector in rad), and back.
  static Rigid3d Exp(const Vector6d& twist);
  Vector6d Log() const;

 private:
  Eigen::Quaterniond rotation_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation_ = Eigen::Vector3d::Zero();
};

// The rotation of a rotation vector (axis times angle in rad), and back.
Eigen::Quaterniond ExpRotation(const Eigen::Vector3d& rotation_vector);
Eigen::Vector3d LogRotation(const Eigen::Quaterniond& rotation);

}  // namespace msf
