// Pictures of what was found to move.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "dynamic/dynamic_filter.h"

namespace msf {

// What a picture shows.
struct DynamicsView {
  int64_t frame = 0;
  cv::Mat color;  // 8-bit BGR or grey
  std::vector<Eigen::Vector2f> points_px;
  DynamicResult result;
  std::string tracking;  // one line about the frame's pose
};

// The image with masks tinted, objects framed in the colour of their state with id, class and
// score, points coloured by reason, and a legend below that also tells how old the detections are.
// Width and height are even, as video wants them.
cv::Mat DrawDynamics(const DynamicsView& view);

}  // namespace msf
