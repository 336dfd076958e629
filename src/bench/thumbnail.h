// Small pictures inside other files.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

namespace msf {

// The picture at that width, as a JPEG in a "data:" address.
std::string ThumbnailAddress(const cv::Mat& picture, int width_px);

}  // namespace msf
