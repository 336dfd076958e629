// Finds the camera again in a map it has seen before.
#pragma once

#include <functional>
#include <optional>

#include "tracking/pose_tracking.h"

namespace msf {

struct RelocalizationOptions {
  double match_ratio = 0.75;
  int min_matches = 15;
  int ransac_iterations = 300;
  double ransac_confidence = 0.99;
  int ransac_min_inliers = 10;
  int min_inliers = 50;
  double wide_radius_px = 10;
  int wide_max_distance = 100;
  double narrow_radius_px = 3;
  int narrow_max_distance = 64;
  int narrow_from_inliers = 30;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("match_ratio", match_ratio, "best to second best descriptor");
    visit("min_matches", min_matches, "matches that make a candidate worth trying");
    visit("ransac_iterations", ransac_iterations, "at most this many random samples");
    visit("ransac_confidence", ransac_confidence, "probability to have drawn a good sample");
    visit("ransac_min_inliers", ransac_min_inliers, "inliers of a first pose");
    visit("min_inliers", min_inliers, "inliers of success");
    visit("wide_radius_px", wide_radius_px, "first guided search, px at level 0");
    visit("wide_max_distance", wide_max_distance, "and its descriptor distance");
    visit("narrow_radius_px", narrow_radius_px, "second guided search, px at level 0");
    visit("narrow_max_distance", narrow_max_distance, "and its descriptor distance");
    visit("narrow_from_inliers", narrow_from_inliers,
          "the second search is tried above this many inliers");
  }
  Status Check() const;
};

struct Relocalization {
  Rigid3d T_cw;
  std::vector<PointMatch> matches;
  KeyFrameId keyframe;
};

// Tries the candidates in their order: words, PnP with RANSAC, optimisation, guided search. `seed`
// makes it repeatable.
std::optional<Relocalization> Relocalize(const TrackingContext& context,
                                         const RelocalizationOptions& options, const Map& map,
                                         const std::vector<KeyFrameId>& candidates,
                                         const FrameFeatures& features, const BagOfWords& words,
                                         uint64_t seed);

}  // namespace msf
