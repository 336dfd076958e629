// The image at shrinking sizes.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "feature/scale_levels.h"

namespace msf {

// Grey image of an 8-bit BGR or grey one; shares the pixels of the latter.
void ToGrey(const cv::Mat& color, cv::Mat& grey);

// levels[0] is `grey`; level l is the bilinear interpolation of level l - 1 at size round(size /
// scale(l)). A pixel centre x of level 0 lies at (x + 0.5) * width_l / width_0 - 0.5 of level l.
// Levels too small for a patch are left out.
void BuildPyramid(const cv::Mat& grey, const ScaleLevels& scales, std::vector<cv::Mat>& levels);

}  // namespace msf
