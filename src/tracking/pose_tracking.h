// The steps that find a frame's pose: match points whose place is known, then optimise.
#pragma once

#include <vector>

#include "map/map.h"
#include "matching/point_projection.h"
#include "tracking/frame.h"
#include "tracking/tracking_options.h"

namespace msf {

// What stays the same from frame to frame.
struct TrackingContext {
  const Camera& camera;
  const ScaleLevels& levels;
  const TrackingOptions& options;
  const NoiseOptions& noise;

  double CloseDepth() const { return camera.baseline_m() * options.close_depth_baselines; }
};

// A feature of the frame that shows a point of the map.
struct PointMatch {
  int feature = -1;
  MapPointId point;
  Eigen::Vector3d p_w;
  double weight = 1;  // static probability of point and feature
};

PointMatch MakePointMatch(const MapPoint& point, const FrameFeatures& features, int feature);

// The points of the last frame, searched where `T_cw_predicted` puts them (twice as wide when too
// few are found).
std::vector<PointMatch> MatchLastFrame(const TrackingContext& context, const Map& map,
                                       const Frame& last, const FrameFeatures& features,
                                       const Rigid3d& T_cw_predicted);

// The points of a keyframe, matched by visual words; `ratio` bounds best against second best
// descriptor.
std::vector<PointMatch> MatchKeyFrame(const Map& map, const KeyFrame& keyframe,
                                      const BagOfWords& keyframe_words,
                                      const FrameFeatures& features, const BagOfWords& words,
                                      double ratio);

struct LocalMatches {
  std::vector<PointMatch> matches;   // new ones only
  std::vector<MapPointId> expected;  // points that should be visible from T_cw, found or not
};

// The local points that should be visible from `T_cw`, apart from those matched already.
LocalMatches MatchLocalPoints(const TrackingContext& context,
                              const std::vector<PointSnapshot>& points,
                              const FrameFeatures& features, const Rigid3d& T_cw,
                              const std::vector<PointMatch>& matched, double radius_factor);

// A feature that the frame does without, since it seems to move, where a point of the map should be
// seen and looks like it.
struct Suspect {
  int removed_feature = -1;
  const PointSnapshot* point = nullptr;
};

// The suspects among `removed`; `matched`: points that were found elsewhere. They point into
// `points`.
std::vector<Suspect> FindSuspects(const TrackingContext& context,
                                  const std::vector<PointSnapshot>& points,
                                  const FrameFeatures& removed, const Rigid3d& T_cw,
                                  const std::vector<PointMatch>& matched);

// Optimises the pose on the matches, starting at `T_cw`, and drops the matches that disagree. False
// (nothing changed but the matches that disagree are gone) when fewer than `min_inliers` remain.
bool OptimizeFramePose(const TrackingContext& context, const FrameFeatures& features,
                       int min_inliers, std::vector<PointMatch>& matches, Rigid3d& T_cw);

}  // namespace msf
