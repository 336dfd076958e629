#include "mapping/keyframe_culling.h"

namespace msf {
namespace {

bool IsRedundantPoint(const Map& map, const MapPoint& point, const KeyFrame& keyframe, int level,
                      int enough) {
  if (static_cast<int>(point.observations.size()) <= enough) return false;
  int as_fine = 0;
  for (const Observation& observation : point.observations) {
    if (observation.keyframe == keyframe.id) continue;
    const KeyFrame& other = *map.FindKeyFrame(observation.keyframe);
    if (other.features->level[observation.feature] <= level + 1 && ++as_fine >= enough) return true;
  }
  return false;
}

bool IsRedundant(const Map& map, const KeyFrame& keyframe, const MappingOptions& options) {
  const double close_m = map.camera().baseline_m() * options.close_depth_baselines;
  const FrameFeatures& features = *keyframe.features;
  int close = 0, redundant = 0;
  for (int i = 0; i < features.size(); ++i) {
    if (!keyframe.points[i].valid() || !features.HasDepth(i) || features.depth_m[i] > close_m)
      continue;
    ++close;
    const MapPoint& point = *map.FindPoint(keyframe.points[i]);
    redundant +=
        IsRedundantPoint(map, point, keyframe, features.level[i], options.redundant_observers);
  }
  return redundant > options.redundant_share * close;
}

}  // namespace

std::vector<KeyFrameId> CullRedundantKeyFrames(const MappingOptions& options, KeyFrameId around,
                                               Map& map) {
  std::vector<KeyFrameId> culled;
  for (const auto& [id, weight] : CovisibilityGraph::Neighbours(map.covisibility().All(around))) {
    const bool is_root = !map.tree().Parent(id).valid();
    if (is_root || !map.tree().LoopEdges(id).empty() ||
        !IsRedundant(map, *map.FindKeyFrame(id), options))
      continue;
    map.CullKeyFrame(id);
    culled.push_back(id);
  }
  return culled;
}

}  // namespace msf
