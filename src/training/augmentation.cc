#include "training/augmentation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "detection/turned_box.h"
#include "training/photometric.h"

namespace msf {

namespace {

constexpr double kPi = 3.14159265358979323846;
const cv::Scalar kGrey(114, 114, 114);

double Uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

cv::Matx33d Translation(double x, double y) { return {1, 0, x, 0, 1, y, 0, 0, 1}; }

cv::Matx23d TopRows(const cv::Matx33d& map) {
  return {map(0, 0), map(0, 1), map(0, 2), map(1, 0), map(1, 1), map(1, 2)};
}

double DrawAngle(const AugmentationOptions& options, Random& random) {
  const double kind = Uniform(random, 0.0, 1.0);
  if (kind < options.rotate_upright) return Uniform(random, -5.0, 5.0);
  if (kind < options.rotate_upright + options.rotate_quarter) {
    return (Uniform(random, 0.0, 1.0) < 0.5 ? -90.0 : 90.0) + Uniform(random, -20.0, 20.0);
  }
  return Uniform(random, -options.rotate_degrees, options.rotate_degrees);
}

// Four images of full size around a point of a canvas of twice the side.
LabeledImage MakeMosaic(const std::vector<LabeledImage>& images, size_t index, int side,
                        Random& random) {
  LabeledImage mosaic{cv::Mat(2 * side, 2 * side, CV_8UC3, kGrey), {}};
  const int cx = static_cast<int>(Uniform(random, 0.5, 1.5) * side);
  const int cy = static_cast<int>(Uniform(random, 0.5, 1.5) * side);
  for (int quadrant = 0; quadrant < 4; ++quadrant) {
    if (quadrant > 0) index = random() % images.size();
    const LabeledImage& image = images[index];
    const double scale = static_cast<double>(side) / std::max(image.pixels.cols, image.pixels.rows);
    const double x = quadrant % 2 == 0 ? cx - image.pixels.cols * scale : cx;
    const double y = quadrant / 2 == 0 ? cy - image.pixels.rows * scale : cy;
    const cv::Matx23d map(scale, 0, x, 0, scale, y);
    cv::warpAffine(image.pixels, mosaic.pixels, map, mosaic.pixels.size(), cv::INTER_LINEAR,
                   cv::BORDER_TRANSPARENT);
    for (const VocObject& object :
         TransformObjects(image.objects, map, mosaic.pixels.size(), 0.1, kTurnedCorners)) {
      mosaic.objects.push_back(object);
    }
  }
  return mosaic;
}

// A shift after which the border cuts 30 to 65 % of a random object.
cv::Point2d BorderCropShift(const std::vector<VocObject>& objects, int side, Random& random) {
  const VocObject& object = objects[random() % objects.size()];
  const double part = Uniform(random, 0.3, 0.65);
  switch (random() % 4) {
    case 0:
      return {-(object.x0 + part * (object.x1 - object.x0)), 0.0};
    case 1:
      return {side - (object.x1 - part * (object.x1 - object.x0)), 0.0};
    case 2:
      return {0.0, -(object.y0 + part * (object.y1 - object.y0))};
    default:
      return {0.0, side - (object.y1 - part * (object.y1 - object.y0))};
  }
}

// Rotation, scale, flip and shift about the middle of the source, ending in the middle of the
// picture.
cv::Matx33d DrawMap(const LabeledImage& source, bool is_mosaic, int side,
                    const AugmentationOptions& options, Random& random) {
  const double angle = DrawAngle(options, random) * kPi / 180.0;
  const double fit =
      is_mosaic ? 1.0
                : static_cast<double>(side) / std::max(source.pixels.cols, source.pixels.rows);
  const double scale = fit * Uniform(random, 1.0 - options.scale, 1.0 + options.scale);
  const double flip = Uniform(random, 0.0, 1.0) < options.flip ? -1.0 : 1.0;
  const cv::Matx33d linear(flip * scale * std::cos(angle), -scale * std::sin(angle), 0,  //
                           flip * scale * std::sin(angle), scale * std::cos(angle), 0, 0, 0, 1);
  const double dx = Uniform(random, -options.translate, options.translate) * side;
  const double dy = Uniform(random, -options.translate, options.translate) * side;
  cv::Matx33d map = Translation(0.5 * side + dx, 0.5 * side + dy) * linear *
                    Translation(-0.5 * source.pixels.cols, -0.5 * source.pixels.rows);
  if (Uniform(random, 0.0, 1.0) < options.border_crop) {
    const std::vector<VocObject> placed =
        TransformObjects(source.objects, TopRows(map), {side, side}, 0.5, options.turned_outline);
    if (!placed.empty()) {
      const cv::Point2d shift = BorderCropShift(placed, side, random);
      map = Translation(shift.x, shift.y) * map;
    }
  }
  return map;
}

double AngleOf(const cv::Matx23d& map) { return std::atan2(-map(0, 1), map(1, 1)); }

}  // namespace

Status AugmentationOptions::Check() const {
  for (double share : {mosaic, rotate_upright, rotate_quarter, border_crop, flip, blur, min_visible,
                       saturation, value, hue}) {
    if (!(share >= 0.0 && share <= 1.0))
      return Status::Error("shares of the augmentation must lie in [0, 1]");
  }
  if (!(turned_outline >= 1.0 && turned_outline <= 2.0))
    return Status::Error("augmentation.turned_outline must lie in [1, 2]");
  if (!(scale >= 0.0 && scale < 1.0)) return Status::Error("augmentation.scale must lie in [0, 1)");
  return Status::Ok();
}

std::vector<VocObject> TransformObjects(const std::vector<VocObject>& objects,
                                        const cv::Matx23d& map, cv::Size size, double min_visible,
                                        double q) {
  std::vector<VocObject> kept;
  for (const VocObject& object : objects) {
    const auto [x0, y0, x1, y1] = TurnBox({object.x0, object.y0, object.x1, object.y1}, map, q);
    VocObject cut = object;
    cut.x0 = std::clamp(x0, 0.0F, static_cast<float>(size.width));
    cut.y0 = std::clamp(y0, 0.0F, static_cast<float>(size.height));
    cut.x1 = std::clamp(x1, 0.0F, static_cast<float>(size.width));
    cut.y1 = std::clamp(y1, 0.0F, static_cast<float>(size.height));
    const float visible = (cut.x1 - cut.x0) * (cut.y1 - cut.y0) / ((x1 - x0) * (y1 - y0));
    if (visible >= min_visible && cut.x1 - cut.x0 >= 2.0F && cut.y1 - cut.y0 >= 2.0F)
      kept.push_back(cut);
  }
  return kept;
}

LabeledImage MakeTrainingPicture(const std::vector<LabeledImage>& images, size_t index, int side,
                                 const AugmentationOptions& options, Random& random) {
  const bool is_mosaic = Uniform(random, 0.0, 1.0) < options.mosaic;
  const LabeledImage source = is_mosaic ? MakeMosaic(images, index, side, random) : images[index];
  const cv::Matx23d map = TopRows(DrawMap(source, is_mosaic, side, options, random));
  LabeledImage picture;
  cv::warpAffine(source.pixels, picture.pixels, map, {side, side}, cv::INTER_LINEAR,
                 cv::BORDER_CONSTANT, kGrey);
  picture.objects = TransformObjects(source.objects, map, {side, side}, options.min_visible,
                                     options.turned_outline);
  picture.angle = AngleOf(map);
  ChangeColours(picture.pixels, options.hue, options.saturation, options.value, random);
  if (Uniform(random, 0.0, 1.0) < options.blur) Blur(picture.pixels, random);
  return picture;
}

}  // namespace msf
