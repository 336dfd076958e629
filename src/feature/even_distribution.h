// Choosing corners so that they cover the picture evenly.
#pragma once

#include <opencv2/core/types.hpp>
#include <vector>

#include "feature/fast_corners.h"

namespace msf {

// At most `count` of the corners of `area`: the area is cut into quarters again and again, coarse
// cells before fine ones and among equals the fullest first, until there are `count` cells that
// hold a corner; each keeps its strongest. Reorders `corners`; the result depends on nothing but
// their set and order.
std::vector<Corner> DistributeEvenly(const cv::Rect& area, int count, std::vector<Corner>& corners);

}  // namespace msf
