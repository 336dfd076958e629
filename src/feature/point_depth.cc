#include "feature/point_depth.h"

#include <cmath>

namespace msf {

float PointDepth(const cv::Mat& depth, const Eigen::Vector2f& image_px, double depth_factor) {
  const int x = static_cast<int>(std::lround(image_px.x())),
            y = static_cast<int>(std::lround(image_px.y()));
  if (x < 0 || y < 0 || x >= depth.cols || y >= depth.rows) return 0;
  return static_cast<float>(depth.at<uint16_t>(y, x) / depth_factor);
}

}  // namespace msf
