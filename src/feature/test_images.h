// Images for the tests and benchmarks of this room.
#pragma once

#include <memory>
#include <opencv2/imgproc.hpp>
#include <random>

#include "sensor/rgbd_frame.h"

namespace msf {

// A grey image full of corners at many scales: overlapping rectangles and ellipses of random
// brightness, slightly smoothed.
inline cv::Mat TexturedImage(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  const auto draw = [&](int below) {
    return static_cast<int>(random() % static_cast<unsigned>(below));
  };
  cv::Mat image(height, width, CV_8UC1, cv::Scalar(128));
  for (int i = 0; i < width * height / 400; ++i) {
    const cv::Point centre(draw(width), draw(height));
    const cv::Size size(3 + draw(30), 3 + draw(30));
    const cv::RotatedRect box(centre, size, static_cast<float>(draw(180)));
    if (i % 2 == 0) {
      cv::ellipse(image, box, cv::Scalar(draw(256)), cv::FILLED);
    } else {
      cv::Point2f corners[4];
      box.points(corners);
      const std::vector<cv::Point> polygon(corners, corners + 4);
      cv::fillConvexPoly(image, polygon, cv::Scalar(draw(256)));
    }
  }
  cv::GaussianBlur(image, image, {3, 3}, 0.6);
  return image;
}

// A frame of that image with depth 2 m everywhere and a camera without distortion.
inline RgbdFrame FrameOf(const cv::Mat& image) {
  Camera camera{.width = image.cols,
                .height = image.rows,
                .fx = 525,
                .fy = 525,
                .cx = image.cols / 2.0,
                .cy = image.rows / 2.0};
  RgbdFrame frame;
  frame.color = image;
  frame.depth = cv::Mat(image.size(), CV_16UC1, cv::Scalar(10000));
  frame.camera = std::make_shared<const Camera>(camera);
  return frame;
}

}  // namespace msf
