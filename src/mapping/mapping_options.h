// Options of mapping; the defaults are those of the published RGB-D configurations of
// ORB-SLAM-class systems.
#pragma once

#include "optimization/bundle_adjustment.h"
#include "optimization/feature_observation.h"
#include "util/status.h"

namespace msf {

struct MappingOptions {
  double min_found_ratio = 0.25;
  int max_weak_strength = 3;
  double min_static_probability = 0.3;
  int num_neighbours = 10;
  double max_parallax_cosine = 0.9998;
  double min_baselines = 1.0;
  double fuse_radius_px = 3.0;
  int num_second_neighbours = 5;
  int max_bundle_keyframes = 30;
  double redundant_share = 0.9;
  int redundant_observers = 3;
  double close_depth_baselines = 40;
  BundleOptions bundle;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("min_found_ratio", min_found_ratio, "young points found less often than expected go");
    visit("max_weak_strength", max_weak_strength,
          "young points go that after two keyframes have no more observations (one with depth "
          "counts twice)");
    visit("min_static_probability", min_static_probability,
          "features and points that are less likely to stand still do not stay in the map");
    visit("num_neighbours", num_neighbours,
          "covisible keyframes that a new one is triangulated and fused with");
    visit("max_parallax_cosine", max_parallax_cosine, "rays closer to parallel do not triangulate");
    visit("min_baselines", min_baselines,
          "keyframes closer together (in virtual baselines) do not triangulate");
    visit("fuse_radius_px", fuse_radius_px,
          "search radius for duplicates of a point, px at level 0");
    visit("num_second_neighbours", num_second_neighbours,
          "neighbours of neighbours that points are fused with");
    visit("max_bundle_keyframes", max_bundle_keyframes,
          "keyframes that move in a local bundle adjustment");
    visit("redundant_share", redundant_share,
          "a keyframe goes when this share of its close points ...");
    visit("redundant_observers", redundant_observers,
          "... is seen by so many others, at most one level coarser");
    visit("close_depth_baselines", close_depth_baselines,
          "depths below this many virtual baselines are close (reliable)");
    visit("bundle", bundle, "");
  }
  Status Check() const;
};

}  // namespace msf
