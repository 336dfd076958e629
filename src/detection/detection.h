// What a detector reports.
#pragma once

#include <vector>

#include "util/strong_id.h"

namespace msf {

// An axis-aligned box in pixels of the original image; x1 and y1 lie outside, so that the width is
// x1 - x0.
struct ImageBox {
  float x0 = 0;
  float y0 = 0;
  float x1 = 0;
  float y1 = 0;

  float width() const { return x1 - x0; }
  float height() const { return y1 - y0; }
  float area() const { return width() > 0 && height() > 0 ? width() * height() : 0; }
  bool Contains(float x, float y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }
};

// Intersection over union, 0..1; 0 for empty boxes.
float IntersectionOverUnion(const ImageBox& a, const ImageBox& b);

// One object.
struct Detection {
  int class_id = 0;  // index into Detector::class_names()
  float score = 0;   // 0..1
  ImageBox box;
};

// All objects of one frame, best score first.
struct Detections {
  FrameId frame;
  double time_s = 0;
  std::vector<Detection> objects;
};

// What becomes of detections that a better one of their class overlaps.
struct OverlapRule {
  float max_iou = 0.7F;  // beyond: dropped
  float decay = 0;       // else: score times exp(-iou^2 / decay); 0 leaves scores alone
  float min_score = 0;   // dropped where that takes them below
  size_t max_count = 300;
};

// Non-maximum suppression per class, with scores that overlaps lower (Bodla et al., "Soft-NMS",
// ICCV 2017). Best first; equal scores keep their order.
std::vector<Detection> SuppressOverlaps(std::vector<Detection> detections, const OverlapRule& rule);

}  // namespace msf
