// Options of loop closing and map merging; the defaults are those of the published RGB-D
// configurations of ORB-SLAM-class systems.
#pragma once

#include "estimation/rigid_alignment_ransac.h"
#include "optimization/bundle_adjustment.h"
#include "optimization/pose_graph.h"
#include "optimization/pose_optimizer.h"
#include "util/status.h"

namespace msf {

// When two keyframes count as two looks at one place.
struct PlaceVerificationOptions {
  int num_window_neighbours = 10;
  double match_ratio = 0.8;
  int min_word_matches = 20;
  RigidAlignmentOptions alignment;
  double guided_radius_px = 8;
  int guided_max_distance = 75;
  int min_guided_matches = 50;
  int min_refined_matches = 20;
  double tight_radius_px = 4;
  int tight_max_distance = 50;
  int min_tight_matches = 80;
  double min_agreeing_depth_share = 0.7;
  double min_seen_share = 0.08;
  int num_checked_neighbours = 5;
  int min_neighbour_matches = 30;
  int num_agreeing_keyframes = 3;
  int max_missed_keyframes = 2;
  double max_drift_share = 0.2;
  double min_allowed_drift_m = 1.0;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("num_window_neighbours", num_window_neighbours,
          "best covisible keyframes that form the window of a candidate together with it");
    visit("match_ratio", match_ratio, "best to second best descriptor when matching by words");
    visit("min_word_matches", min_word_matches, "matches by words that a candidate needs");
    visit("alignment", alignment, "");
    visit("guided_radius_px", guided_radius_px, "first guided search, px at level 0");
    visit("guided_max_distance", guided_max_distance, "and its descriptor distance");
    visit("min_guided_matches", min_guided_matches, "matches that it must give");
    visit("min_refined_matches", min_refined_matches,
          "inliers that the refined relative pose must have");
    visit("tight_radius_px", tight_radius_px, "search with the refined pose, px at level 0");
    visit("tight_max_distance", tight_max_distance, "and its descriptor distance");
    visit("min_tight_matches", min_tight_matches, "matches that it must give");
    visit("min_agreeing_depth_share", min_agreeing_depth_share,
          "of the matches found by place alone, the share whose depth must agree as well");
    visit("min_seen_share", min_seen_share,
          "of the window's points that should be visible, the share that must be found");
    visit("num_checked_neighbours", num_checked_neighbours,
          "covisible keyframes of the present one that are asked whether they agree");
    visit("min_neighbour_matches", min_neighbour_matches,
          "matches that a keyframe that agrees must have");
    visit("num_agreeing_keyframes", num_agreeing_keyframes,
          "keyframes that must agree, neighbours or following ones");
    visit("max_missed_keyframes", max_missed_keyframes,
          "keyframes in a row that may fail to agree before a hypothesis is dropped");
    visit("max_drift_share", max_drift_share,
          "a loop cannot reveal more drift than this share of the way travelled since");
    visit("min_allowed_drift_m", min_allowed_drift_m, "drift that is believed after any way, m");
  }
  Status Check() const;
};

struct LoopClosingOptions {
  bool enabled = true;
  int min_keyframes = 12;
  int num_candidates = 3;
  int min_keyframes_between_loops = 10;
  PlaceVerificationOptions verification;
  int strong_covisibility = 100;
  double fuse_radius_px = 4;
  int max_seam_keyframes = 25;
  PoseOptimizerOptions pose;
  PoseGraphOptions pose_graph;
  BundleOptions weld;
  BundleOptions full_bundle{.robust_iterations = 5, .final_iterations = 10};

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("enabled", enabled, "recognise places seen before, close loops and merge maps");
    visit("min_keyframes", min_keyframes, "keyframes that a map needs before loops are looked for");
    visit("num_candidates", num_candidates,
          "places to verify per keyframe, of the same map and of other maps");
    visit("min_keyframes_between_loops", min_keyframes_between_loops,
          "keyframes after a closed loop in which no other is looked for");
    visit("verification", verification, "");
    visit("strong_covisibility", strong_covisibility,
          "shared points that make two keyframes an edge of the pose graph");
    visit("fuse_radius_px", fuse_radius_px,
          "search radius for duplicates of a point after a correction, px at level 0");
    visit("max_seam_keyframes", max_seam_keyframes,
          "keyframes on either side of a loop's or merge's seam");
    visit("pose", pose, "");
    visit("pose_graph", pose_graph, "");
    visit("weld", weld, "");
    visit("full_bundle", full_bundle, "");
  }
  Status Check() const;
};

}  // namespace msf
