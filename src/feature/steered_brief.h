// Orientation and descriptor of a point (Rublee et al., ICCV 2011).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "feature/descriptor.h"

namespace msf {

// Direction, in [-pi, pi], from the pixel (x, y) to the centroid of brightness over the disc of
// kPatchRadiusPx around it. The disc must lie inside the image.
float PatchOrientation(const cv::Mat& image, int x, int y);

// The descriptor of the place (x, y) + offset_px of a smoothed image: the pattern turned by the
// angle, each sample at the nearest pixel. The disc around the pixel must lie inside with a margin
// of ceil(|offset|).
Descriptor DescribePatch(const cv::Mat& smoothed, int x, int y, const Eigen::Vector2f& offset_px,
                         float angle_rad);

}  // namespace msf
