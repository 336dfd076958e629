// Training pictures made from labelled images: mosaics, rotations, border crops, scales, flips,
// colours and blur.
#pragma once

#include <opencv2/core.hpp>
#include <random>
#include <string>
#include <vector>

#include "detection/turned_box.h"
#include "io/voc_dataset.h"
#include "util/status.h"

namespace msf {

// A decoded image (BGR) with its labelled boxes in its pixels.
struct LabeledImage {
  cv::Mat pixels;
  std::vector<VocObject> objects;
  double angle = 0.0;  // by which the image was rotated, radians, clockwise
};

struct AugmentationOptions {
  double mosaic = 0.2;
  double rotate_upright = 0.6;
  double rotate_quarter = 0.15;
  double rotate_degrees = 45.0;
  double turned_outline = 1.5;
  double scale = 0.35;
  double translate = 0.1;
  double border_crop = 0.2;
  double flip = 0.5;
  double hue = 0.015;
  double saturation = 0.7;
  double value = 0.4;
  double blur = 0.15;
  double min_visible = 0.3;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("mosaic", mosaic, "share of pictures put together from four images");
    visit("rotate_upright", rotate_upright, "share of pictures rotated by at most 5 degrees");
    visit("rotate_quarter", rotate_quarter,
          "share of pictures rotated by about a quarter turn to either side");
    visit("rotate_degrees", rotate_degrees,
          "largest rotation of the other pictures, degrees to either side");
    visit("turned_outline", turned_outline,
          "boxes of turned objects: 1 around the turned corners of their boxes, 2 around the "
          "ellipses "
          "in these");
    visit("scale", scale, "pictures are scaled by 1 - scale to 1 + scale");
    visit("translate", translate, "largest shift as a part of the picture's side");
    visit("border_crop", border_crop,
          "share of pictures shifted so that the border cuts 30 to 65 % of some object");
    visit("flip", flip, "share of pictures mirrored left to right");
    visit("hue", hue, "largest relative change of hue");
    visit("saturation", saturation, "largest relative change of saturation");
    visit("value", value, "largest relative change of brightness");
    visit("blur", blur, "share of pictures blurred, by motion or defocus");
    visit("min_visible", min_visible,
          "objects with a smaller visible part of their box lose their label");
  }
  Status Check() const;
};

using Random = std::mt19937_64;

// The square picture of `side` pixels made from images[index] (and random others for a mosaic);
// borders are grey (114). The same generator state gives the same picture.
LabeledImage MakeTrainingPicture(const std::vector<LabeledImage>& images, size_t index, int side,
                                 const AugmentationOptions& options, Random& random);

// `objects` under the affine map (2x3, old pixels to new ones): their boxes as TurnBox(q) draws
// them, cut to `size`. Objects that keep less than `min_visible` of the mapped box, or less than 2
// pixels of a side, are dropped.
std::vector<VocObject> TransformObjects(const std::vector<VocObject>& objects,
                                        const cv::Matx23d& map, cv::Size size, double min_visible,
                                        double q = kTurnedCorners);

}  // namespace msf
