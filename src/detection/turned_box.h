// The box of an object after its picture was turned, known only by its box before.
#pragma once

#include <opencv2/core/matx.hpp>

#include "detection/detection.h"

namespace msf {

// What the object is taken to fill of its former box: the superellipse |x / a|^p + |y / b|^p <= 1
// in it, with 1 / p + 1 / q = 1. q = 1: all of the box, so that its turned corners decide; q = 2:
// the ellipse.
//
// Boxes around turned corners are far too large: of 176 silhouettes of people, turned by 15 to 45
// degrees, the true box overlaps that of the corners by 0.59 to 0.65 (intersection over union) and
// that of the ellipse by 0.81 to 0.86. (Kalra et al., "Towards Rotation Invariance in Object
// Detection", ICCV 2021, found the same for the classes of COCO.)
inline constexpr double kTurnedCorners = 1.0;
inline constexpr double kTurnedOutline = 2.0;

// The upright box around what fills `box`, under the affine map `map` (old pixels to new ones). `q`
// as above, at least 1.
ImageBox TurnBox(const ImageBox& box, const cv::Matx23d& map, double q);

}  // namespace msf
