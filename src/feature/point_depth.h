// The depth that belongs to a point of the colour image.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "geometry/rigid3d.h"
#include "sensor/camera.h"

namespace msf {

// Depth in metres at the pixel nearest to `image_px` of a registered 16-bit depth image (value /
// depth_factor = metres); 0 when there is none.
float PointDepth(const cv::Mat& depth, const Eigen::Vector2f& image_px, double depth_factor);

// The same for a depth image that was taken from another place: `T_depth_color` takes coordinates
// of the colour camera to those of the camera when it took the depth image. `uv_px` is undistorted,
// and so is the depth in the colour camera that comes back. The pixel is found by the rotation
// alone: within a frame's time the translation moves it by far less.
float PointDepthFromElsewhere(const cv::Mat& depth, const Eigen::Vector2f& uv_px,
                              const Camera& camera, const Rigid3d& T_depth_color);

}  // namespace msf
