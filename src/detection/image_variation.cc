#include "detection/image_variation.h"

#include <algorithm>
#include <cmath>

#include "detection/turned_box.h"
#include "detection/turned_picture.h"
#include "util/check.h"

namespace msf {
namespace {

ImageBox CutBy(const ImageBox& box, float width, float height) {
  return {std::clamp(box.x0, 0.0f, width), std::clamp(box.y0, 0.0f, height),
          std::clamp(box.x1, 0.0f, width), std::clamp(box.y1, 0.0f, height)};
}

}  // namespace

LabeledPicture Rotate(const LabeledPicture& picture, double degrees, double q) {
  const int side = std::max(picture.pixels.cols, picture.pixels.rows);
  const cv::Matx23d map =
      TurnAboutCentre(picture.pixels.size(), degrees * CV_PI / 180, {side, side});
  LabeledPicture turned;
  turned.pixels = WarpOntoGrey(picture.pixels, map, {side, side});
  for (LabeledBox object : picture.objects) {
    const ImageBox hull = TurnBox(object.box, map, q);
    object.box = CutBy(hull, static_cast<float>(side), static_cast<float>(side));
    object.ignored = object.ignored || object.box.area() < 0.5f * hull.area();
    if (object.box.area() > 0) turned.objects.push_back(object);
  }
  return turned;
}

LabeledPicture CutObject(const LabeledPicture& picture, size_t target, double fraction,
                         ImageSide side) {
  MSF_CHECK(target < picture.objects.size() && fraction >= 0 && fraction < 1,
            "no such object or cut");
  const ImageBox& box = picture.objects[target].box;
  cv::Rect kept(0, 0, picture.pixels.cols, picture.pixels.rows);
  const auto along = [&](float low, float high, double share) {
    return static_cast<int>(std::lround(low + (high - low) * share));
  };
  switch (side) {
    case ImageSide::kLeft:
      kept.x = along(box.x0, box.x1, fraction);
      break;
    case ImageSide::kTop:
      kept.y = along(box.y0, box.y1, fraction);
      break;
    case ImageSide::kRight:
      kept.width = along(box.x0, box.x1, 1 - fraction);
      break;
    case ImageSide::kBottom:
      kept.height = along(box.y0, box.y1, 1 - fraction);
      break;
  }
  kept.x = std::clamp(kept.x, 0, picture.pixels.cols - 1);
  kept.y = std::clamp(kept.y, 0, picture.pixels.rows - 1);
  kept.width = std::clamp(kept.width, 1, picture.pixels.cols - kept.x);
  kept.height = std::clamp(kept.height, 1, picture.pixels.rows - kept.y);
  LabeledPicture cut;
  cut.pixels = picture.pixels(kept).clone();
  for (size_t i = 0; i < picture.objects.size(); ++i) {
    LabeledBox object = picture.objects[i];
    object.box.x0 -= static_cast<float>(kept.x);
    object.box.x1 -= static_cast<float>(kept.x);
    object.box.y0 -= static_cast<float>(kept.y);
    object.box.y1 -= static_cast<float>(kept.y);
    object.box = CutBy(object.box, static_cast<float>(kept.width), static_cast<float>(kept.height));
    object.ignored = object.ignored || i != target;
    if (object.box.area() > 0) cut.objects.push_back(object);
  }
  return cut;
}

}  // namespace msf
