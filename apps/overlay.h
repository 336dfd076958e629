// Pictures of what a detector found.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "detection/detection.h"

namespace msf {

// A colour copy of the image with every box, its class and score.
cv::Mat DrawDetections(const cv::Mat& image, const std::vector<Detection>& detections,
                       const std::vector<std::string>& class_names);

}  // namespace msf
