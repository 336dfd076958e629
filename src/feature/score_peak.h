// Where between the pixels a corner is.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace msf {

// Offset, at most 0.6 px in x and y, from the pixel (x, y) to the maximum of the paraboloid that
// fits the 5x5 scores around it best under a Gaussian weight of 1 px; zero where the fit has no
// maximum. On real sequences it halves the reprojection error of matched FAST corners: a score is a
// maximum of minima and noisy by itself, so a fit to 25 of them is worth more than the usual
// parabola through 3.
Eigen::Vector2f RefineScorePeak(const cv::Mat& scores, int x, int y);

}  // namespace msf
