#include "flow/point_flow.h"

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "util/check.h"

namespace msf {
namespace {

// Pixel centres at whole numbers, also in the smaller image.
cv::Point2f ToSmall(const Eigen::Vector2f& px, int shrink) {
  const float s = 1.0f / static_cast<float>(shrink);
  return {(px.x() + 0.5f) * s - 0.5f, (px.y() + 0.5f) * s - 0.5f};
}

Eigen::Vector2f ToFull(const cv::Point2f& px, int shrink) {
  const auto s = static_cast<float>(shrink);
  return {(px.x + 0.5f) * s - 0.5f, (px.y + 0.5f) * s - 0.5f};
}

}  // namespace

Status FlowOptions::Check() const {
  if (shrink != 1 && shrink != 2 && shrink != 4)
    return Status::Error("flow.shrink must be 1, 2 or 4");
  if (window_px < 3 || window_px > 101)
    return Status::Error("flow.window_px must be from 3 to 101");
  if (levels < 0 || levels > 8) return Status::Error("flow.levels must be from 0 to 8");
  if (iterations < 1) return Status::Error("flow.iterations must be at least 1");
  if (!(max_error > 0)) return Status::Error("flow.max_error must be positive");
  return Status::Ok();
}

FlowImage::FlowImage(const cv::Mat& color, const FlowOptions& options) : shrink_(options.shrink) {
  cv::Mat grey = color;
  if (color.channels() == 3) cv::cvtColor(color, grey, cv::COLOR_BGR2GRAY);
  if (shrink_ > 1)
    cv::resize(grey, grey, {grey.cols / shrink_, grey.rows / shrink_}, 0, 0, cv::INTER_AREA);
  cv::buildOpticalFlowPyramid(grey, pyramid_, {options.window_px, options.window_px},
                              options.levels);
}

std::vector<FlowPoint> FollowPoints(const FlowImage& from, const FlowImage& to,
                                    std::span<const Eigen::Vector2f> points_px,
                                    std::span<const Eigen::Vector2f> guesses_px,
                                    const FlowOptions& options) {
  MSF_CHECK(guesses_px.empty() || guesses_px.size() == points_px.size(), "one guess per point");
  std::vector<FlowPoint> result(points_px.size());
  if (points_px.empty() || from.empty() || to.empty()) return result;
  std::vector<cv::Point2f> start, end;
  for (size_t i = 0; i < points_px.size(); ++i) {
    start.push_back(ToSmall(points_px[i], from.shrink()));
    end.push_back(guesses_px.empty() ? start.back() : ToSmall(guesses_px[i], from.shrink()));
  }
  std::vector<uint8_t> found;
  std::vector<float> error;
  const cv::TermCriteria stop(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, options.iterations,
                              0.02);
  cv::calcOpticalFlowPyrLK(from.pyramid(), to.pyramid(), start, end, found, error,
                           {options.window_px, options.window_px}, options.levels, stop,
                           cv::OPTFLOW_USE_INITIAL_FLOW, 1e-4);
  const cv::Size size = to.pyramid()[0].size();
  for (size_t i = 0; i < result.size(); ++i) {
    const bool inside = end[i].x >= 0 && end[i].y >= 0 &&
                        end[i].x <= static_cast<float>(size.width - 1) &&
                        end[i].y <= static_cast<float>(size.height - 1);
    result[i] = {ToFull(end[i], from.shrink()),
                 found[i] != 0 && inside && error[i] <= options.max_error};
  }
  return result;
}

}  // namespace msf
