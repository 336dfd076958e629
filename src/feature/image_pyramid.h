// The image at shrinking sizes.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "feature/scale_levels.h"

namespace msf {

// The grey image of an 8-bit BGR one, in `converted`; a grey one is returned as it is, sharing its
// pixels.
cv::Mat ToGrey(const cv::Mat& color, cv::Mat& converted);

// levels[0] is `grey`; level l is the bilinear interpolation of level l - 1 at size round(size /
// scale(l)). A pixel centre x of level 0 lies at (x + 0.5) * width_l / width_0 - 0.5 of level l.
// Levels without a pixel are left out.
void BuildPyramid(const cv::Mat& grey, const ScaleLevels& scales, std::vector<cv::Mat>& levels);

}  // namespace msf
