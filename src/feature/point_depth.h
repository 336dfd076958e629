// The depth that belongs to a point of the colour image.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace msf {

// Depth in metres at the pixel nearest to `image_px` of a registered 16-bit depth image (value /
// depth_factor = metres); 0 when there is none.
float PointDepth(const cv::Mat& depth, const Eigen::Vector2f& image_px, double depth_factor);

}  // namespace msf
