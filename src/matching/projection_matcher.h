// Finds the features of an image that lie where they are expected and look as expected.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "feature/frame_features.h"

namespace msf {

// What is looked for: a descriptor near a place, at some pyramid levels.
struct ProjectionQuery {
  Eigen::Vector2d uv_px;
  double u_right_px = -1;  // where it should be in the virtual right image; < 0: not checked
  double radius_px = 0;
  int min_level = 0;
  int max_level = 0;
  Descriptor descriptor{};
};

struct ProjectionMatchOptions {
  int max_distance = kLooseDescriptorDistance;
  // The best must be below `ratio` times the second best at the same level; 1 = not checked.
  double ratio = 1;
};

// The feature of each query, -1 = none. Features with a set flag in `taken` (empty: none) are left
// out; a feature that suits several queries goes to the closest descriptor (ties: the first query).
std::vector<int> MatchByProjection(const FrameFeatures& features,
                                   std::span<const ProjectionQuery> queries,
                                   const ProjectionMatchOptions& options,
                                   std::span<const uint8_t> taken = {});

}  // namespace msf
