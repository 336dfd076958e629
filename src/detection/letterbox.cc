#include "detection/letterbox.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "util/check.h"

namespace msf {

Letterbox::Letterbox(cv::Size image, cv::Size network) : image_(image), network_(network) {
  MSF_CHECK(image.width > 0 && image.height > 0, "an image needs pixels");
  scale_ = std::min(static_cast<float>(network.width) / static_cast<float>(image.width),
                    static_cast<float>(network.height) / static_cast<float>(image.height));
  const auto scaled = [&](int size, int limit) {
    return std::clamp(static_cast<int>(std::lround(static_cast<float>(size) * scale_)), 1, limit);
  };
  inside_.width = scaled(image.width, network.width);
  inside_.height = scaled(image.height, network.height);
  inside_.x = (network.width - inside_.width) / 2;
  inside_.y = (network.height - inside_.height) / 2;
}

void Letterbox::Fill(const cv::Mat& image, uint8_t* rgb) const {
  MSF_CHECK(image.size() == image_ && image.depth() == CV_8U,
            "another image than the letterbox was made for");
  cv::Mat target(network_, CV_8UC3, rgb);
  if (inside_.size() != network_) target.setTo(cv::Scalar::all(114));
  cv::Mat scaled = image;
  if (image.size() != inside_.size())
    cv::resize(image, scaled, inside_.size(), 0, 0, cv::INTER_LINEAR);
  const cv::Mat inside = target(inside_);
  cv::cvtColor(scaled, inside, image.channels() == 1 ? cv::COLOR_GRAY2RGB : cv::COLOR_BGR2RGB);
}

ImageBox Letterbox::ToImage(const ImageBox& box) const {
  const auto x = [&](float v) {
    return std::clamp((v - static_cast<float>(inside_.x)) / scale_, 0.0f,
                      static_cast<float>(image_.width));
  };
  const auto y = [&](float v) {
    return std::clamp((v - static_cast<float>(inside_.y)) / scale_, 0.0f,
                      static_cast<float>(image_.height));
  };
  return {x(box.x0), y(box.y0), x(box.x1), y(box.y1)};
}

ImageBox Letterbox::ToNetwork(const ImageBox& box) const {
  const float dx = static_cast<float>(inside_.x), dy = static_cast<float>(inside_.y);
  return {box.x0 * scale_ + dx, box.y0 * scale_ + dy, box.x1 * scale_ + dx, box.y1 * scale_ + dy};
}

}  // namespace msf
