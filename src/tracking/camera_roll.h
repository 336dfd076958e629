// How the camera is rolled, learnt from its own poses.
#pragma once

#include <Eigen/Core>

#include "geometry/rigid3d.h"

namespace msf {

// Nothing measures gravity here. But whoever carries a camera holds it level most of the time, so
// that down is the direction which is closest to the right angle with the x axes of all cameras so
// far, and, while these leave a choice because the camera has not looked around yet, closest to
// their mean y axis. Pitch does not disturb that: it turns the camera about its x axis. (x and y as
// they would be without the turn by which the camera is mounted.)
class CameraRoll {
 public:
  // `mounted_rad`: what TurnUpright_rad() is for a camera that is held as it is most of the time.
  explicit CameraRoll(double mounted_rad = 0);

  // The pose of a frame. `same_world`: in the coordinates of the pose before; if not, the camera is
  // taken to be held as it was last, and what was learnt until then counts for less.
  void Add(const Rigid3d& T_cw, bool same_world);

  // The angle, clockwise as one looks at the picture, by which it has to be turned to be upright,
  // as of the last pose; as mounted before there is one. 0 when it is less than 45 degrees
  // (detectors cope with that, and all turning costs pixels), and while the camera looks almost
  // straight up or down, where nothing is upright.
  double TurnUpright_rad() const;

 private:
  void MoveTo(const Eigen::Matrix3d& R_wc);

  const Eigen::Vector3d x_c_, y_c_;  // axes of an upright picture, in the camera's coordinates
  Eigen::Matrix3d sum_xx_ = Eigen::Matrix3d::Zero();  // of x axes, world coordinates
  Eigen::Vector3d sum_y_ = Eigen::Vector3d::Zero();   // of y axes
  double num_poses_ = 0;
  Eigen::Matrix3d R_wc_ = Eigen::Matrix3d::Identity();  // of the last pose
  Eigen::Vector3d down_c_;                              // in that camera's coordinates
};

}  // namespace msf
