// Depth at a quarter of the resolution: objects are found and masked on it.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <opencv2/core/mat.hpp>

#include "sensor/rgbd_frame.h"

namespace msf {

// Cells of kCellSize x kCellSize pixels.
class CoarseDepth {
 public:
  static constexpr int kCellSize = 4;

  CoarseDepth() = default;
  explicit CoarseDepth(const RgbdFrame& frame);

  // Metres, 0 = none; CV_32F.
  const cv::Mat1f& metres() const { return metres_; }
  int rows() const { return metres_.rows; }
  int cols() const { return metres_.cols; }
  bool empty() const { return metres_.empty(); }

  // Cell of a pixel, clamped to the image.
  cv::Point CellOf(float x_px, float y_px) const {
    return {std::clamp(static_cast<int>(x_px) / kCellSize, 0, cols() - 1),
            std::clamp(static_cast<int>(y_px) / kCellSize, 0, rows() - 1)};
  }
  float At(const Eigen::Vector2f& image_px) const {
    return metres_(CellOf(image_px.x(), image_px.y()));
  }

 private:
  cv::Mat1f metres_;
};

}  // namespace msf
