// A point of the world that has been seen to stand still for long, as one image shows it.
#pragma once

#include <Eigen/Core>

namespace msf {

struct Landmark {
  Eigen::Vector2f image_px;  // in the image as it was taken
  Eigen::Vector3d p_c;       // on the ray of that pixel, in the camera's coordinates, m
};

}  // namespace msf
