// Which part of a box is the object: the near cluster of depths that hangs together.
#pragma once

#include <optional>
#include <vector>

#include "detection/detection.h"
#include "dynamic/background.h"
#include "dynamic/coarse_depth.h"
#include "dynamic/dynamic_options.h"

namespace msf {

struct ObjectMask {
  cv::Mat1b cells;    // like CoarseDepth: 255 = object
  float depth_m = 0;  // typical depth, 0 = not known
  int area = 0;       // cells
  ImageBox box;       // around the cells, px

  bool empty() const { return area == 0; }
  bool Covers(const Eigen::Vector2f& image_px) const {
    if (empty()) return false;
    const int r = static_cast<int>(image_px.y()) / CoarseDepth::kCellSize,
              c = static_cast<int>(image_px.x()) / CoarseDepth::kCellSize;
    return r >= 0 && c >= 0 && r < cells.rows && c < cells.cols && cells(r, c) != 0;
  }
};

// The object in `box` (pixels), without what `background` has confirmed as static. A person who has
// sat still and was not found for a while looks like background, too: where `box` is a good
// detection (`trusted`) and almost all of it is confirmed, the detector knows better.
// `expected_depth_m`: where the object was a moment ago, if that is known. With little depth in the
// box what has none is the object, too; without any the box is the mask.
ObjectMask MaskInBox(const CoarseDepth& depth, const BlockVerdicts& background, const ImageBox& box,
                     bool trusted, std::optional<float> expected_depth_m,
                     const ObjectMaskOptions& options);

// All of `box`.
ObjectMask WholeBox(const CoarseDepth& depth, const ImageBox& box);

// The object around some of its points (pixels), whose typical depth is known, within `box`.
ObjectMask MaskAroundPoints(const CoarseDepth& depth, const BlockVerdicts& background,
                            const std::vector<Eigen::Vector2f>& points_px, float depth_m,
                            const ImageBox& box, const ObjectMaskOptions& options);

// Both together; the larger one says the depth.
ObjectMask Union(const ObjectMask& a, const ObjectMask& b);

}  // namespace msf
