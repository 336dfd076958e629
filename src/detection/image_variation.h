// Labelled images as a SLAM camera sees people: rolled, and cut off by the border.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "detection/detection_metrics.h"
#include "detection/turned_box.h"

namespace msf {

struct LabeledPicture {
  cv::Mat pixels;  // 8-bit BGR
  std::vector<LabeledBox> objects;
};

// The picture in the middle of a grey square with its longer side, turned by `degrees` around the
// centre: a camera that rolls keeps the scale, and corners leave the square. Boxes become those of
// TurnBox(q), cut by the square; objects of which less than half stays inside are ignored.
LabeledPicture Rotate(const LabeledPicture& picture, double degrees, double q = kTurnedCorners);

enum class ImageSide { kLeft, kTop, kRight, kBottom };

// The part of the picture that remains when a side's border moves inwards until it cuts `fraction`
// of the box of object `target`. All other objects are ignored. 0 <= fraction < 1.
LabeledPicture CutObject(const LabeledPicture& picture, size_t target, double fraction,
                         ImageSide side);

}  // namespace msf
