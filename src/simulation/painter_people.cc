// Heads and clothes. The middle of a picture is the front of the body.
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "simulation/painter.h"

namespace msf {

cv::Mat PaintHead(cv::Size size, const cv::Scalar& skin, const cv::Scalar& hair, Random random) {
  cv::Mat picture(size, CV_8UC3, skin);
  const auto at = [&](double u, double v) {
    return cv::Point(static_cast<int>(u * size.width), static_cast<int>(v * size.height));
  };
  const auto extent = [&](double u, double v) {
    return cv::Size(static_cast<int>(u * size.width), static_cast<int>(v * size.height));
  };
  // Hair: the top all around, longer at the back; a ragged fringe.
  cv::rectangle(picture, at(0, 0), at(1, 0.22), hair, -1);
  cv::rectangle(picture, at(0, 0), at(0.27, 0.78), hair, -1);
  cv::rectangle(picture, at(0.73, 0), at(1, 0.78), hair, -1);
  for (int i = 0; i < 60; ++i) {
    const double u = random.Uniform(0.25, 0.75);
    cv::line(picture, at(u, 0.15), at(u + random.Uniform(-0.03, 0.03), random.Uniform(0.22, 0.32)),
             hair, 4, cv::LINE_AA);
  }
  for (int i = 0; i < 260; ++i) {
    const double u = random.Uniform(), v = random.Uniform(0, 0.75);
    if (v > 0.25 && u > 0.25 && u < 0.75) continue;
    cv::line(picture, at(u, v), at(u + random.Uniform(-0.02, 0.02), v + 0.08),
             NearbyColor(hair, 35, random), 2, cv::LINE_AA);
  }
  for (const double side : {-1., 1.}) {
    const double u = 0.5 + side * 0.075;
    cv::ellipse(picture, at(u, 0.47), extent(0.034, 0.022), 0, 0, 360, {240, 240, 240}, -1,
                cv::LINE_AA);
    cv::circle(picture, at(u, 0.47), size.height / 50, {70, 60, 40}, -1, cv::LINE_AA);
    cv::circle(picture, at(u, 0.47), size.height / 100, {10, 10, 10}, -1, cv::LINE_AA);
    cv::line(picture, at(u - 0.04, 0.41), at(u + 0.04, 0.405), hair * 0.8, size.height / 60,
             cv::LINE_AA);
    cv::ellipse(picture, at(u + side * 0.04, 0.62), extent(0.05, 0.06), 0, 0, 360,
                skin * 0.94 + cv::Scalar(0, 0, 12), -1, cv::LINE_AA);
    cv::circle(picture, at(0.5 + side * 0.02, 0.63), size.height / 90, skin * 0.5, -1, cv::LINE_AA);
  }
  cv::ellipse(picture, at(0.5, 0.74), extent(0.055, 0.022), 0, 0, 360, {90, 85, 175}, -1,
              cv::LINE_AA);
  cv::line(picture, at(0.45, 0.74), at(0.55, 0.74), {50, 40, 90}, 2, cv::LINE_AA);
  if (random.Chance(0.4)) {  // a beard
    for (int i = 0; i < 500; ++i) {
      const double u = random.Uniform(0.3, 0.7), v = random.Uniform(0.8, 1);
      cv::line(picture, at(u, v), at(u, v + 0.03), NearbyColor(hair, 25, random), 1, cv::LINE_AA);
    }
  }
  AddMottle(picture, 3, 12, random);
  AddMottle(picture, 3, 3, random);
  return picture;
}

cv::Mat PaintShirt(cv::Size size, const cv::Scalar& base, Random random) {
  cv::Mat picture = PaintFabric(size, base, random.Fork(1));
  const int middle = size.width / 2;
  if (random.Chance(0.5)) {  // buttons
    cv::line(picture, {middle, 0}, {middle, size.height}, base * 0.4, 2);
    for (int y = size.height / 8; y < size.height; y += size.height / 7) {
      cv::circle(picture, {middle + 5, y}, 4, {235, 235, 235}, -1, cv::LINE_AA);
    }
  } else {  // a print
    const cv::Rect print(middle - size.width / 10, size.height / 3, size.width / 5,
                         size.height / 3);
    PaintBookCover(print.size(), random.Fork(2)).copyTo(picture(print));
  }
  cv::rectangle(picture, {0, 0, size.width, size.height / 14}, base * 0.6, -1);  // collar
  cv::rectangle(picture, {0, size.height * 13 / 14, size.width, size.height / 14}, {45, 50, 60},
                -1);  // belt
  return picture;
}

cv::Mat PaintTrousers(cv::Size size, const cv::Scalar& base, Random random) {
  cv::Mat picture(size, CV_8UC3, base);
  AddMottle(picture, 12, 30, random);
  AddMottle(picture, 8, 6, random);
  AddMottle(picture, 7, 2, random);
  for (int i = 0; i < size.area() / 700; ++i) {  // folds, worn spots, seams
    const cv::Point at(random.Int(0, size.width - 1), random.Int(0, size.height - 1));
    const cv::Point to(at.x + random.Int(-9, 9), at.y + random.Int(4, 26));
    cv::line(picture, at, to, base * random.Uniform(0.45, 1.8), random.Int(1, 3), cv::LINE_AA);
  }
  for (const int x : {size.width / 4, size.width * 3 / 4}) {
    cv::line(picture, {x, 0}, {x, size.height}, base * 0.6, 2);
    cv::rectangle(picture, {x - 14, size.height / 5, 28, size.height / 6}, base * 0.7, 2);
  }
  return picture;
}

}  // namespace msf
