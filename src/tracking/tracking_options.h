// Options of tracking; the defaults are those of the published RGB-D configurations of
// ORB-SLAM-class systems.
#pragma once

#include "optimization/feature_observation.h"
#include "optimization/pose_optimizer.h"
#include "util/status.h"

namespace msf {

struct KeyFramePolicyOptions {
  double max_interval_s = 1.0;
  double reference_ratio = 0.85;
  double hidden_exponent = 2;
  double urgent_ratio = 0.25;
  int min_inliers = 15;
  int min_tracked_close = 100;
  int max_untracked_close = 70;
  int max_queued = 3;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("max_interval_s", max_interval_s, "a keyframe is due this long after the last, s");
    visit("reference_ratio", reference_ratio,
          "wanted when fewer than this share of the reference's points is tracked ...");
    visit("hidden_exponent", hidden_exponent,
          "... sooner while movers hide much: what may be missing counts by the share of features "
          "that does not move, to this power; 0: as without movers");
    visit("urgent_ratio", urgent_ratio, "wanted even from a busy mapper below this share");
    visit("min_inliers", min_inliers, "never with fewer tracked points");
    visit("min_tracked_close", min_tracked_close, "with fewer tracked close points ...");
    visit("max_untracked_close", max_untracked_close,
          "... and more close points that are not in the map, wanted");
    visit("max_queued", max_queued, "declined while the mapper has this many waiting");
  }
};

struct SmoothingOptions {
  double position_s = 0.1;
  double rotation_s = 0.045;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("position_s", position_s,
          "positions of the whole run are smoothed over about so long, s; 0: as tracked");
    visit("rotation_s", rotation_s,
          "and rotations, which are found more exactly and change faster; 0: as tracked");
  }
};

struct HindsightOptions {
  double after_s = 2;
  int max_frames = 10000;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit(
        "after_s", after_s,
        "every frame is matched to the map once more so much later, s, and in the end its pose is "
        "that which the final map tells; negative: poses stay as tracked");
    visit("max_frames", max_frames,
          "of so many of the newest frames (about 13 kB each); older ones stay as tracked");
  }
};

struct TrackingOptions {
  int min_initial_points = 200;
  int min_initial_depths = 100;
  double close_depth_baselines = 40;
  double motion_radius_px = 15;
  int min_motion_matches = 20;
  double reference_match_ratio = 0.7;
  int min_reference_matches = 15;
  int min_pose_inliers = 10;
  int max_local_keyframes = 80;
  int max_neighbours = 10;
  double local_radius_factor = 5;
  double local_radius_factor_relocalized = 5;
  double local_radius_factor_refined = 3;
  int local_search_rounds = 2;
  double local_match_ratio = 0.8;
  bool undo_rolling_shutter = true;
  double velocity_trend = 0.5;
  bool undo_stamp_lag = true;
  HindsightOptions hindsight;
  SmoothingOptions smoothing;
  int min_local_inliers = 30;
  int min_local_inliers_relocalized = 50;
  double recently_lost_s = 3;
  int min_keyframes_to_keep_map = 10;
  double min_static_probability = 0.3;
  double readmit_probability = 0.12;
  double readmit_point_probability = 0.6;
  double landmark_probability = 0.6;
  double landmark_age_s = 1;
  int max_landmarks = 100;
  KeyFramePolicyOptions keyframe;
  PoseOptimizerOptions pose;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("min_initial_points", min_initial_points, "features that the first frame of a map needs");
    visit("min_initial_depths", min_initial_depths, "of these, features with depth");
    visit("close_depth_baselines", close_depth_baselines,
          "depths below this many virtual baselines are close (reliable)");
    visit("motion_radius_px", motion_radius_px,
          "search radius around the predicted place at level 0, px");
    visit("min_motion_matches", min_motion_matches,
          "with fewer matches the radius is doubled, then given up");
    visit("reference_match_ratio", reference_match_ratio,
          "best to second best, matching to the reference keyframe");
    visit("min_reference_matches", min_reference_matches,
          "matches that the reference keyframe must give");
    visit("min_pose_inliers", min_pose_inliers, "inliers of a first pose estimate");
    visit("max_local_keyframes", max_local_keyframes, "keyframes in the local map");
    visit("max_neighbours", max_neighbours,
          "covisible keyframes that each keyframe adds to the local map");
    visit("local_radius_factor", local_radius_factor,
          "factor on the search radius in the local map");
    visit("local_radius_factor_relocalized", local_radius_factor_relocalized,
          "the same just after relocalisation");
    visit("local_radius_factor_refined", local_radius_factor_refined,
          "the same in the rounds after the first");
    visit("local_search_rounds", local_search_rounds,
          "searches of the local map, each followed by an optimisation");
    visit("local_match_ratio", local_match_ratio,
          "best to second best at the same level, matching the local map");
    visit("undo_rolling_shutter", undo_rolling_shutter,
          "points go where the middle row would show them (camera.rolling_shutter_s)");
    visit(
        "velocity_trend", velocity_trend,
        "share of its change since the image before with which the velocity goes on until the "
        "exposure of this one: all of it would be right, but amplifies noise; 0: the mean velocity "
        "since the last image");
    visit("undo_stamp_lag", undo_stamp_lag,
          "the trajectory tells where the camera was at the time stamps, not when its images were "
          "exposed (camera.stamp_lag_s)");
    visit("hindsight", hindsight, "");
    visit("smoothing", smoothing, "");
    visit("min_local_inliers", min_local_inliers, "inliers with which a frame counts as tracked");
    visit("min_local_inliers_relocalized", min_local_inliers_relocalized,
          "the same within a second of relocalisation");
    visit("recently_lost_s", recently_lost_s,
          "relocalisation is tried this long before a new map starts, s");
    visit("min_keyframes_to_keep_map", min_keyframes_to_keep_map,
          "a smaller map is forgotten when lost");
    visit("min_static_probability", min_static_probability,
          "features less likely static never become map points");
    visit("readmit_probability", readmit_probability,
          "features that were removed as moving, but are at least this likely static, come back "
          "where the map has a static point that looks like them, and all of them where tracking "
          "would be lost without; 1: never ...");
    visit("readmit_point_probability", readmit_point_probability,
          "... and how likely static that point must be");
    visit("landmark_probability", landmark_probability,
          "points of the map that are at least this likely static ...");
    visit(
        "landmark_age_s", landmark_age_s,
        "... and have been in it for so long, s, tell how the camera has moved before it is known "
        "what else has ...");
    visit("max_landmarks", max_landmarks, "... by the flow of at most so many; 0: none");
    visit("keyframe", keyframe, "");
    visit("pose", pose, "");
  }
  Status Check() const;
};

}  // namespace msf
