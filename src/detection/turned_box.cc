#include "detection/turned_box.h"

#include <cmath>

#include "util/check.h"

namespace msf {

ImageBox TurnBox(const ImageBox& box, const cv::Matx23d& map, double q) {
  MSF_CHECK(q >= 1.0, "a box cannot be filled by more than all of it");
  const double a = box.width() / 2.0, b = box.height() / 2.0;
  const cv::Vec2d centre = map * cv::Vec3d(box.x0 + a, box.y0 + b, 1.0);
  // Support function of the superellipse along each axis of the new picture.
  const auto reach = [&](int axis) {
    return std::pow(
        std::pow(std::abs(map(axis, 0)) * a, q) + std::pow(std::abs(map(axis, 1)) * b, q), 1.0 / q);
  };
  const double x = reach(0), y = reach(1);
  return {static_cast<float>(centre[0] - x), static_cast<float>(centre[1] - y),
          static_cast<float>(centre[0] + x), static_cast<float>(centre[1] + y)};
}

}  // namespace msf
