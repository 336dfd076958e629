#include "simulation/lens.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace msf {

Lens::Lens(const Camera& camera) : ideal_(camera) {
  if (!camera.HasDistortion()) return;
  source_.create(camera.height, camera.width, CV_32FC2);
  Eigen::Vector2d low(0, 0), high(camera.width - 1, camera.height - 1);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector2d ideal_px = camera.Undistort({x, y});
      low = low.cwiseMin(ideal_px);
      high = high.cwiseMax(ideal_px);
      source_.at<cv::Vec2f>(y, x) = {static_cast<float>(ideal_px.x()),
                                     static_cast<float>(ideal_px.y())};
    }
  }
  const Eigen::Vector2d first = (low.array() - 2).floor(), last = (high.array() + 2).ceil();
  source_ -= cv::Scalar(first.x(), first.y());
  ideal_ = {.width = static_cast<int>(last.x() - first.x()) + 1,
            .height = static_cast<int>(last.y() - first.y()) + 1,
            .fx = camera.fx,
            .fy = camera.fy,
            .cx = camera.cx - first.x(),
            .cy = camera.cy - first.y(),
            .bf = camera.bf,
            .depth_factor = camera.depth_factor,
            .fps = camera.fps};
}

void Lens::Apply(const RenderedView& ideal, RenderedView& view) const {
  if (source_.empty()) {
    view = ideal;
    return;
  }
  cv::remap(ideal.color, view.color, source_, {}, cv::INTER_LINEAR);
  view.depth_m.create(source_.size(), CV_32FC1);
  view.cosine.create(source_.size(), CV_32FC1);
  view.label.create(source_.size(), CV_8UC1);
  for (int y = 0; y < source_.rows; ++y) ApplyToSurfaces(ideal, y, view);
}

void Lens::ApplyToSurfaces(const RenderedView& ideal, int y, RenderedView& view) const {
  const cv::Vec2f* source = source_.ptr<cv::Vec2f>(y);
  for (int x = 0; x < source_.cols; ++x) {
    const int nearest_x = cvRound(source[x][0]), nearest_y = cvRound(source[x][1]);
    float depth_m = ideal.depth_m.at<float>(nearest_y, nearest_x);
    view.cosine.at<float>(y, x) = ideal.cosine.at<float>(nearest_y, nearest_x);
    view.label.at<uint8_t>(y, x) = ideal.label.at<uint8_t>(nearest_y, nearest_x);
    const int left = static_cast<int>(source[x][0]), top = static_cast<int>(source[x][1]);
    const float tx = source[x][0] - static_cast<float>(left),
                ty = source[x][1] - static_cast<float>(top);
    const float* upper = ideal.depth_m.ptr<float>(top) + left;
    const float* lower = ideal.depth_m.ptr<float>(top + 1) + left;
    const float nearest = std::min({upper[0], upper[1], lower[0], lower[1]});
    const float farthest = std::max({upper[0], upper[1], lower[0], lower[1]});
    if (nearest > 0 && farthest < 1.03f * nearest) {
      depth_m = 1 / ((1 - ty) * ((1 - tx) / upper[0] + tx / upper[1]) +
                     ty * ((1 - tx) / lower[0] + tx / lower[1]));
    }
    view.depth_m.at<float>(y, x) = depth_m;
  }
}

}  // namespace msf
