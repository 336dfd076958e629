// Options of the removal of moving things.
#pragma once

#include <string>
#include <vector>

#include "flow/point_flow.h"
#include "util/status.h"

namespace msf {

// What mode full asks of a point.
struct MotionTestOptions {
  double min_residual_px = 1.5;
  double sigmas = 3;
  double flow_sigma_px = 0.35;
  double flow_share = 0.08;
  double unsteady_share = 0.5;
  double typical_share = 0.3;
  double depth_sigma_m = 0.006;
  double depth_sigma_per_m2 = 0.004;
  double look_back_s = 0.2;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("min_residual_px", min_residual_px,
          "L: flow left after the camera's motion is taken out, px; less never counts as motion");
    visit("sigmas", sigmas, "motion must exceed the expected noise this many times");
    visit("flow_sigma_px", flow_sigma_px, "noise of the flow of a point of pyramid level 0, px");
    visit("flow_share", flow_share,
          "part of the flow that the camera causes which may be wrong: the shutter rolls, colour "
          "and depth differ in time");
    visit("unsteady_share", unsteady_share,
          "part of the change of the camera's motion from image to image that the rolling shutter "
          "turns into flow");
    visit("typical_share", typical_share,
          "where the median point uses more than this share of its tolerance, all tolerances grow "
          "in proportion");
    visit("depth_sigma_m", depth_sigma_m, "noise of depth, m, at depth 0 ...");
    visit("depth_sigma_per_m2", depth_sigma_per_m2,
          "... and its growth with the square of depth, 1/m");
    visit("look_back_s", look_back_s,
          "slow motion is looked for against an image so much older, s");
  }
};

// Comparison of depth with that of older views.
struct BackgroundOptions {
  double keep_every_s = 0.15;
  double youngest_s = 0.6;
  double oldest_s = 8;
  int num_views = 8;
  int min_memory_views = 3;
  double tolerance_m = 0.012;
  double tolerance_per_m2 = 0.01;
  double max_turn_px = 6;
  int min_intruder_blocks = 14;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("keep_every_s", keep_every_s, "a view is kept so often, s");
    visit("youngest_s", youngest_s, "views that are compared are at least so old, s ...");
    visit("oldest_s", oldest_s, "... and at most so old, s");
    visit("num_views", num_views, "views that are compared; 0: none");
    visit("min_memory_views", min_memory_views,
          "views in which a surface has to be somebody's, more than in which it is the world's, to "
          "be his where nothing is detected now; 0: never");
    visit("tolerance_m", tolerance_m, "depths differ by more than this, m, at depth 0 ...");
    visit("tolerance_per_m2", tolerance_per_m2, "... and its growth with the square of depth, 1/m");
    visit(
        "max_turn_px", max_turn_px,
        "views taken while the camera turns faster, px of an image 640 px wide per 1/30 s, do not "
        "tell what is new: their depth is displaced");
    visit("min_intruder_blocks", min_intruder_blocks,
          "blocks (8 x 8 px of an image 640 px wide) of something new that make an object of "
          "unknown class");
  }
};

// Large flat surfaces.
struct PlaneOptions {
  int max_planes = 4;
  int hypotheses = 40;
  double min_share = 0.08;
  double covered_share = 0.2;
  double tolerance_m = 0.012;
  double tolerance_per_m2 = 0.005;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("max_planes", max_planes, "planes looked for where there are objects; 0: none");
    visit("hypotheses", hypotheses, "samples for each");
    visit("min_share", min_share, "share of the image outside the boxes that makes a plane");
    visit("covered_share", covered_share,
          "the same, of the whole image, where boxes cover most of it: people are not flat, but a "
          "part of one may be");
    visit("tolerance_m", tolerance_m, "distance of a plane's points from it, m, at depth 0 ...");
    visit("tolerance_per_m2", tolerance_per_m2, "... and its growth with the square of depth, 1/m");
  }
};

struct ObjectMaskOptions {
  double depth_band_m = 0.5;
  double max_step_share = 0.03;
  double max_step_m = 0.02;
  double box_margin = 0.1;
  double mover_margin = 0.3;
  int grow_px = 0;
  int grow_without_depth_px = 4;
  double min_depth_share = 0.15;
  double near_depth_share = 0.5;
  double max_image_share = 0.9;
  double max_mover_share = 0.55;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("depth_band_m", depth_band_m,
          "an object reaches so far before and behind its typical depth, m");
    visit("max_step_share", max_step_share,
          "neighbouring cells of an object differ in depth by at most this share of it ...");
    visit("max_step_m", max_step_m, "... plus this, m");
    visit("box_margin", box_margin, "an object may reach beyond its box by this share of the box");
    visit("mover_margin", mover_margin,
          "the same for a mover of unknown class, whose box is only where motion was seen so far");
    visit("grow_px", grow_px, "the mask is grown by so much, px (by whole cells of 4 px)");
    visit("grow_without_depth_px", grow_without_depth_px,
          "and so far over pixels without depth, px; twice as far where these are the object");
    visit("min_depth_share", min_depth_share,
          "with less valid depth inside a box the whole box is the mask");
    visit("near_depth_share", near_depth_share,
          "with less the pixels without depth are: the object may be too near to be measured");
    visit("max_image_share", max_image_share, "larger masks are distrusted");
    visit("max_mover_share", max_mover_share,
          "and larger ones of movers of unknown class, unless this very image shows them moving");
  }
};

struct ObjectTrackOptions {
  double min_iou = 0.25;
  double bridge_s = 0.7;
  double bridge_per_detection_s = 0.1;
  double weak_s = 0.5;
  double sure_score = 0.5;
  double bridge_still_s = 2.5;
  double start_score = 0.25;
  double potential_score = 0.4;
  double continue_score = 0.1;
  double settle_s = 3;
  double mover_settle_s = 0.25;
  double moving_share = 0.25;
  double settled_share = 0.08;
  int min_tested_points = 5;
  double settled_weight = 0.35;
  double mover_share = 0.5;
  double new_share = 0.35;
  int min_cluster_points = 8;
  double cluster_px = 40;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("min_iou", min_iou, "overlap with which a detection continues a track");
    visit("bridge_s", bridge_s, "an object that is detected no more is followed for so long, s");
    visit("bridge_per_detection_s", bridge_per_detection_s,
          "but one that was never found with sure_score only for so long per detection, and for as "
          "long as detections take to come, s");
    visit("weak_s", weak_s,
          "detections that could not start an object continue it for so long after one that could, "
          "or after it was seen to move, s");
    visit("sure_score", sure_score, "score of a detection that leaves no doubt");
    visit("bridge_still_s", bridge_still_s,
          "one that was detected often and still looks the same in depth is followed for so long, "
          "s");
    visit("start_score", start_score, "score with which a known dynamic class starts a track");
    visit("potential_score", potential_score, "the same for a potentially dynamic class");
    visit("continue_score", continue_score, "score with which a detection continues a track");
    visit("settle_s", settle_s,
          "an object of a known dynamic class that has not moved for so long counts as static, s");
    visit("mover_settle_s", mover_settle_s, "the same for other objects, s");
    visit("moving_share", moving_share,
          "share of its points that fail the motion test with which an object moves");
    visit("settled_share", settled_share, "share below which it rests");
    visit("min_tested_points", min_tested_points,
          "points without which there is no verdict on an object");
    visit("settled_weight", settled_weight,
          "static probability of the points of a known dynamic object that rests");
    visit("mover_share", mover_share,
          "moving_share of objects of potentially dynamic or unknown class");
    visit("new_share", new_share,
          "an object that stands where the camera has seen through before, with this share of it, "
          "has moved");
    visit("min_cluster_points", min_cluster_points,
          "moving points that make an object of unknown class");
    visit("cluster_px", cluster_px,
          "distance between neighbouring points of such an object, px of an image 640 px wide");
  }
};

struct DynamicOptions {
  std::string mode = "full";
  std::vector<std::string> known_classes = {"person", "bird",       "cat",      "dog",   "horse",
                                            "sheep",  "cow",        "elephant", "bear",  "bicycle",
                                            "car",    "motorcycle", "bus",      "train", "truck"};
  std::vector<std::string> potential_classes = {
      "chair", "couch",    "potted plant", "bottle",  "tv",       "laptop",     "book",
      "cup",   "suitcase", "backpack",     "handbag", "umbrella", "sports ball"};
  std::vector<std::string> class_scores;
  double paper_flow_px = 1.5;
  int paper_window_px = 5;
  bool depth_split = true;
  bool bridging = true;
  bool compensate_camera_motion = true;
  bool weights = true;
  bool unknown_movers = true;
  int min_static_features = 100;
  double min_static_probability = 0.3;
  double suspect_reach_px = 48;
  double max_feature_factor = 1.6;
  double history_s = 0.55;
  MotionTestOptions motion;
  BackgroundOptions background;
  PlaneOptions planes;
  ObjectMaskOptions mask;
  ObjectTrackOptions tracks;
  FlowOptions flow;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit(
        "mode", mode,
        "off; boxes: drop what is in a box; paper: boxes, then raw flow above paper_flow_px; full");
    visit("known_classes", known_classes, "classes that move by themselves");
    visit("potential_classes", potential_classes, "classes that people move");
    visit("class_scores", class_scores,
          "scores with which detections of single classes start an object, such as [cat=0.6]; for "
          "the others tracks.start_score and tracks.potential_score");
    visit("paper_flow_px", paper_flow_px, "mode paper: L, largest flow of a static point, px");
    visit("paper_window_px", paper_window_px, "mode paper: side of the flow's window, px");
    visit("depth_split", depth_split, "inside a box only the near cluster is the object");
    visit("bridging", bridging, "follow objects through missed and late detections");
    visit("compensate_camera_motion", compensate_camera_motion,
          "test the flow that is left after the camera's motion");
    visit("weights", weights, "static probability of points as weight; else yes or no");
    visit("unknown_movers", unknown_movers, "moving clusters outside all boxes are objects, too");
    visit("min_static_features", min_static_features,
          "with fewer static points the least suspicious others are readmitted");
    visit("min_static_probability", min_static_probability,
          "points less likely static are not used");
    visit(
        "suspect_reach_px", suspect_reach_px,
        "with a detector a point whose flow disagrees is removed only so near to an object that is "
        "removed or may be, px of an image 640 px wide; elsewhere it is used with little weight");
    visit("max_feature_factor", max_feature_factor,
          "so many times the points are extracted at most where masks cover the image");
    visit("history_s", history_s, "images are kept for so long, to place late detections, s");
    visit("motion", motion, "");
    visit("background", background, "");
    visit("planes", planes, "");
    visit("mask", mask, "");
    visit("tracks", tracks, "");
    visit("flow", flow, "");
  }
  Status Check() const;
};

}  // namespace msf
