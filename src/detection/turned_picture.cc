#include "detection/turned_picture.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "detection/turned_box.h"
#include "util/check.h"

namespace msf {
namespace {

// What an object is taken to fill of the box it was found in (TurnBox): between all of it and the
// ellipse, as in the labels of turned pictures that the models learn from.
constexpr double kFilled = 1.5;

// The largest scale at which the ellipse in a turned image of `image` pixels fits into `size`.
double ScaleToFit(cv::Size image, double turn_rad, cv::Size size) {
  const double c = std::cos(turn_rad), s = std::sin(turn_rad);
  const double width = std::hypot(image.width * c, image.height * s);
  const double height = std::hypot(image.width * s, image.height * c);
  return std::min(size.width / width, size.height / height);
}

}  // namespace

cv::Matx23d TurnAboutCentre(cv::Size from, double turn_rad, cv::Size to) {
  const double c = std::cos(turn_rad), s = std::sin(turn_rad);
  const double x = from.width / 2.0, y = from.height / 2.0;
  return {c, -s, to.width / 2.0 - c * x + s * y, s, c, to.height / 2.0 - s * x - c * y};
}

cv::Mat WarpOntoGrey(const cv::Mat& image, const cv::Matx23d& map, cv::Size size) {
  cv::Matx23d of_centres = map;  // warpAffine counts from the pixels' centres
  for (int axis = 0; axis < 2; ++axis) of_centres(axis, 2) += (map(axis, 0) + map(axis, 1) - 1) / 2;
  cv::Mat warped;
  cv::warpAffine(image, warped, of_centres, size, cv::INTER_LINEAR, cv::BORDER_CONSTANT,
                 cv::Scalar::all(114));
  return warped;
}

TurnedPicture::TurnedPicture(const cv::Mat& image, double turn_rad, cv::Size size)
    : image_size_(image.size()) {
  MSF_CHECK(!image.empty() && !size.empty(), "an image needs pixels");
  const double scale = ScaleToFit(image.size(), turn_rad, size);
  // Warping looks at four pixels only: a smaller picture is made first.
  const cv::Size scaled_size(std::max(1, static_cast<int>(std::lround(image.cols * scale))),
                             std::max(1, static_cast<int>(std::lround(image.rows * scale))));
  cv::Mat scaled;
  cv::resize(image, scaled, scaled_size, 0, 0, cv::INTER_LINEAR);
  const cv::Matx23d turn = TurnAboutCentre(scaled.size(), turn_rad, size);
  pixels_ = WarpOntoGrey(scaled, turn, size);
  cv::invertAffineTransform(turn, to_image_);
  for (int column = 0; column < 3; ++column) {
    to_image_(0, column) *= static_cast<double>(image.cols) / scaled.cols;
    to_image_(1, column) *= static_cast<double>(image.rows) / scaled.rows;
  }
}

ImageBox TurnedPicture::ToImage(const ImageBox& box) const {
  const ImageBox turned = TurnBox(box, to_image_, kFilled);
  const auto width = static_cast<float>(image_size_.width);
  const auto height = static_cast<float>(image_size_.height);
  return {std::clamp(turned.x0, 0.0f, width), std::clamp(turned.y0, 0.0f, height),
          std::clamp(turned.x1, 0.0f, width), std::clamp(turned.y1, 0.0f, height)};
}

}  // namespace msf
