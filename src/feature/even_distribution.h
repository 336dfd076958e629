// Choosing corners so that they cover the picture evenly.
#pragma once

#include <opencv2/core/types.hpp>
#include <vector>

#include "feature/fast_corners.h"

namespace msf {

// At most `count` of the corners of `area`. `even_share` of them are spread evenly: the area is cut
// into quarters again and again, all cells of one size before the next and the fullest first, until
// that many cells hold a corner; each gives its strongest. The rest are the strongest that are
// left: found again more often, they make poses more exact, while the even ones keep every part of
// the picture in use. Reorders `corners`; the result depends on nothing but their set and order.
std::vector<Corner> DistributeEvenly(const cv::Rect& area, int count, double even_share,
                                     std::vector<Corner>& corners);

}  // namespace msf
