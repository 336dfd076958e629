#include "training/photometric.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace msf {

namespace {

double Uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

}  // namespace

void ChangeColours(cv::Mat& pixels, double hue, double saturation, double value,
                   std::mt19937_64& random) {
  const double h = 1.0 + Uniform(random, -hue, hue);
  const double s = 1.0 + Uniform(random, -saturation, saturation);
  const double v = 1.0 + Uniform(random, -value, value);
  cv::Mat table(1, 256, CV_8UC3);
  for (int i = 0; i < 256; ++i) {
    table.at<cv::Vec3b>(i) = {static_cast<uint8_t>(std::fmod(i * h, 180.0)),
                              cv::saturate_cast<uint8_t>(i * s), cv::saturate_cast<uint8_t>(i * v)};
  }
  cv::Mat hsv;
  cv::cvtColor(pixels, hsv, cv::COLOR_BGR2HSV);
  cv::LUT(hsv, table, hsv);
  cv::cvtColor(hsv, pixels, cv::COLOR_HSV2BGR);
}

void Blur(cv::Mat& pixels, std::mt19937_64& random) {
  if (Uniform(random, 0.0, 1.0) < 0.4) {
    cv::GaussianBlur(pixels, pixels, {}, Uniform(random, 0.5, 1.5));
    return;
  }
  const double length = Uniform(random, 3.0, 11.0);
  const double angle = Uniform(random, 0.0, CV_PI);
  const int size = 2 * static_cast<int>(std::ceil(length / 2.0)) + 1;
  cv::Mat kernel = cv::Mat::zeros(size, size, CV_32F);
  const cv::Point2d middle(size / 2, size / 2);
  const cv::Point2d half(0.5 * length * std::cos(angle), 0.5 * length * std::sin(angle));
  cv::line(kernel, middle - half, middle + half, 1.0F, 1);
  cv::filter2D(pixels, pixels, -1, kernel / cv::sum(kernel)[0]);
}

}  // namespace msf
