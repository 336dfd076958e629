#include "loop_closing/map_bundle.h"

#include <algorithm>
#include <map>

namespace msf {
namespace {

// The observations of a point by the keyframes that have a pose in the problem.
std::vector<BundleObservation> ObservationsOf(const MapPoint& point, const Map& map,
                                              const NoiseOptions& noise,
                                              const std::map<KeyFrameId, int>& pose_of,
                                              int point_index) {
  std::vector<BundleObservation> observations;
  for (const Observation& seen : point.observations) {
    const auto pose = pose_of.find(seen.keyframe);
    if (pose == pose_of.end()) continue;
    const FrameFeatures& features = *map.FindKeyFrame(seen.keyframe)->features;
    const double weight = std::min(point.static_weight, features.static_weight[seen.feature]);
    BundleObservation observation{
        ObserveFeature(features, seen.feature, map.camera(), map.levels(), noise, weight)};
    observation.pose = pose->second;
    observation.point = point_index;
    observations.push_back(observation);
  }
  return observations;
}

// One view without depth leaves the distance open.
bool Locatable(const std::vector<BundleObservation>& observations) {
  return observations.size() >= 2 || (observations.size() == 1 && observations[0].HasDepth());
}

}  // namespace

MapBundle CopyBundle(const Map& map, const NoiseOptions& noise, std::span<const KeyFrameId> free,
                     std::span<const KeyFrameId> fixed) {
  MapBundle bundle;
  bundle.epoch = map.epoch();
  std::map<KeyFrameId, int> pose_of;
  const auto add_poses = [&](std::span<const KeyFrameId> ids, bool is_fixed) {
    for (const KeyFrameId id : ids) {
      const KeyFrame& keyframe = *map.FindKeyFrame(id);
      pose_of[id] = static_cast<int>(bundle.keyframes.size());
      bundle.map_id = keyframe.map_id;
      bundle.keyframes.push_back(id);
      bundle.T_cw_before.push_back(keyframe.T_cw);
      bundle.problem.poses.push_back({keyframe.T_cw, is_fixed});
    }
  };
  add_poses(free, false);
  add_poses(fixed, true);
  for (const MapPointId id : map.PointsSeenBy(free)) {
    const MapPoint& point = *map.FindPoint(id);
    const std::vector<BundleObservation> observations =
        ObservationsOf(point, map, noise, pose_of, static_cast<int>(bundle.points.size()));
    if (!Locatable(observations)) continue;
    bundle.points.push_back(id);
    bundle.p_w_before.push_back(point.p_w);
    bundle.problem.points.push_back({point.p_w});
    bundle.problem.observations.insert(bundle.problem.observations.end(), observations.begin(),
                                       observations.end());
  }
  return bundle;
}

MapCorrection CorrectionOf(const MapBundle& bundle) {
  MapCorrection correction;
  correction.map_id = bundle.map_id;
  correction.epoch = bundle.epoch;
  for (size_t k = 0; k < bundle.keyframes.size(); ++k) {
    correction.motion[bundle.keyframes[k]] =
        bundle.problem.poses[k].fixed
            ? Rigid3d()
            : MotionBetween(bundle.T_cw_before[k], bundle.problem.poses[k].T_cw);
  }
  for (size_t p = 0; p < bundle.points.size(); ++p) {
    correction.points.push_back(
        {bundle.points[p], bundle.p_w_before[p], bundle.problem.points[p].p_w});
  }
  return correction;
}

}  // namespace msf
