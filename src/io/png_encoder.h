// Writes images as PNG (ISO/IEC 15948): the pictures of simulated sequences and of detections.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

namespace msf {

// The PNG file of a CV_8UC1, CV_8UC3 (BGR) or CV_16UC1 image. `level` is libdeflate's: 1 is fast,
// 12 small.
std::string EncodePng(const cv::Mat& image, int level = 1);

}  // namespace msf
