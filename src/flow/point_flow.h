// Where points of one image are in another: pyramidal Lucas-Kanade (Lucas & Kanade, 1981; Bouguet,
// 2001).
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "util/status.h"

namespace msf {

struct FlowOptions {
  int shrink = 2;
  int window_px = 8;  // one more than a vector of 8 px would cost a fifth of the time
  int levels = 2;
  int iterations = 6;
  double max_error = 20;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("shrink", shrink, "the images are made smaller by this factor first: 1, 2 or 4");
    visit("window_px", window_px, "side of the window that is compared, px of the smaller image");
    visit("levels", levels, "pyramid levels above the smaller image");
    visit("iterations", iterations, "steps per level");
    visit("max_error", max_error,
          "mean grey value difference of the window above which a point counts as not found");
  }
  Status Check() const;
};

// An image as the flow needs it: grey, smaller, with pyramid and gradients.
class FlowImage {
 public:
  FlowImage() = default;
  // `color`: 8-bit BGR or grey.
  FlowImage(const cv::Mat& color, const FlowOptions& options);

  bool empty() const { return pyramid_.empty(); }
  int shrink() const { return shrink_; }
  const std::vector<cv::Mat>& pyramid() const { return pyramid_; }

 private:
  int shrink_ = 1;
  std::vector<cv::Mat> pyramid_;
};

struct FlowPoint {
  Eigen::Vector2f image_px = Eigen::Vector2f::Zero();  // in the other image
  bool found = false;                                  // inside the image and similar enough
};

// Follows points of `from` (px of the full image) into `to`, starting the search at `guesses_px`
// (as many, or none: where they were). Both images were made with these options.
std::vector<FlowPoint> FollowPoints(const FlowImage& from, const FlowImage& to,
                                    std::span<const Eigen::Vector2f> points_px,
                                    std::span<const Eigen::Vector2f> guesses_px,
                                    const FlowOptions& options);

}  // namespace msf
