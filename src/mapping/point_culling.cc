#include "mapping/point_culling.h"

namespace msf {

void RecentPoints::Cull(const MappingOptions& options, KeyFrameId newest, Map& map) {
  std::vector<MapPointId> still_young;
  for (const MapPointId id : points_) {
    const MapPoint* point = map.FindPoint(id);
    if (!point) continue;
    const int64_t age = newest.value() - point->first_keyframe.value();
    const bool few_observers = point->observation_strength <= options.max_weak_strength;
    if (point->FoundRatio() < options.min_found_ratio || (age >= 2 && few_observers)) {
      map.RemovePoint(id);
    } else if (age < 3) {
      still_young.push_back(id);
    }
  }
  points_ = std::move(still_young);
}

int CullMovingPoints(const MappingOptions& options, KeyFrameId keyframe, Map& map) {
  std::vector<KeyFrameId> views = map.covisibility().Best(keyframe, options.num_neighbours);
  views.push_back(keyframe);
  int culled = 0;
  for (const MapPointId id : map.PointsSeenBy(views)) {
    if (map.FindPoint(id)->static_weight >= options.min_static_probability) continue;
    map.RemovePoint(id);
    ++culled;
  }
  return culled;
}

}  // namespace msf
