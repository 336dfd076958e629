// Matches between two keyframes with known poses among features that have no map point yet:
// candidates for triangulation.
#pragma once

#include "feature/scale_levels.h"
#include "geometry/rigid3d.h"
#include "matching/word_matcher.h"

namespace msf {

struct EpipolarMatchOptions {
  int max_distance = kStrictDescriptorDistance;
  double max_chi2 = 3.84;  // of the distance to the epipolar line, 95 % with 1 degree of freedom
};

// Pairs (feature of a, feature of b) with the closest descriptor among those that satisfy the
// epipolar constraint of T_ab (b-camera to a-camera coordinates).
std::vector<std::pair<int, int>> MatchByEpipolarLine(const WordImage& a, const WordImage& b,
                                                     const Rigid3d& T_ab, const Camera& camera,
                                                     const ScaleLevels& levels,
                                                     const EpipolarMatchOptions& options);

}  // namespace msf
