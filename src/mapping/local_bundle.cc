#include "mapping/local_bundle.h"

#include <algorithm>
#include <map>

namespace msf {
namespace {

// Gives keyframes and points their index in the problem, in the order in which they are first
// named.
template <typename Id>
class Numbering {
 public:
  // The index of `id`, and whether it is new.
  std::pair<int, bool> Index(Id id) {
    const auto [entry, inserted] = index_.try_emplace(id, static_cast<int>(ids_.size()));
    if (inserted) ids_.push_back(id);
    return {entry->second, inserted};
  }
  std::vector<Id>& ids() { return ids_; }

 private:
  std::map<Id, int> index_;
  std::vector<Id> ids_;
};

// Without a fixed pose the whole could drift: the oldest stays.
void FixGauge(const std::vector<KeyFrameId>& keyframes, std::vector<BundlePose>& poses) {
  if (std::any_of(poses.begin(), poses.end(), [](const BundlePose& pose) { return pose.fixed; }))
    return;
  poses[std::min_element(keyframes.begin(), keyframes.end()) - keyframes.begin()].fixed = true;
}

}  // namespace

LocalBundle CopyLocalBundle(const MappingOptions& options, const NoiseOptions& noise,
                            const Map& map, KeyFrameId keyframe) {
  LocalBundle bundle;
  bundle.epoch = map.epoch();
  std::vector<KeyFrameId> moving =
      map.covisibility().Best(keyframe, options.max_bundle_keyframes - 1);
  moving.insert(moving.begin(), keyframe);
  Numbering<KeyFrameId> numbering;
  const auto add_pose = [&](KeyFrameId id, bool fixed) {
    const auto [index, is_new] = numbering.Index(id);
    if (is_new) bundle.problem.poses.push_back({map.FindKeyFrame(id)->T_cw, fixed});
    return index;
  };
  for (const KeyFrameId id : moving) add_pose(id, !map.tree().Parent(id).valid());
  bundle.points = map.PointsSeenBy(moving);
  for (size_t p = 0; p < bundle.points.size(); ++p) {
    const MapPoint& point = *map.FindPoint(bundle.points[p]);
    bundle.problem.points.push_back({point.p_w});
    for (const Observation& seen : point.observations) {
      const FrameFeatures& features = *map.FindKeyFrame(seen.keyframe)->features;
      const double weight = std::min(point.static_weight, features.static_weight[seen.feature]);
      BundleObservation observation{
          ObserveFeature(features, seen.feature, map.camera(), map.levels(), noise, weight)};
      observation.pose = add_pose(seen.keyframe, true);
      observation.point = static_cast<int>(p);
      bundle.problem.observations.push_back(observation);
    }
  }
  bundle.keyframes = std::move(numbering.ids());
  FixGauge(bundle.keyframes, bundle.problem.poses);
  return bundle;
}

void ApplyLocalBundle(const LocalBundle& bundle, const BundleResult& result, Map& map) {
  if (!result.usable || bundle.epoch != map.epoch()) return;
  const BundleProblem& problem = bundle.problem;
  for (size_t k = 0; k < bundle.keyframes.size(); ++k) {
    if (!problem.poses[k].fixed && map.FindKeyFrame(bundle.keyframes[k]))
      map.SetPose(bundle.keyframes[k], problem.poses[k].T_cw);
  }
  for (size_t o = 0; o < problem.observations.size(); ++o) {
    const BundleObservation& observation = problem.observations[o];
    const MapPointId point = bundle.points[observation.point];
    if (!result.inlier[o] && map.FindPoint(point))
      map.RemoveObservation(point, bundle.keyframes[observation.pose]);
  }
  for (size_t p = 0; p < bundle.points.size(); ++p) {
    if (!map.FindPoint(bundle.points[p])) continue;
    map.SetPosition(bundle.points[p], problem.points[p].p_w);
    map.UpdateNormalAndRange(bundle.points[p]);
  }
}

}  // namespace msf
