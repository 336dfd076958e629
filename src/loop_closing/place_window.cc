#include "loop_closing/place_window.h"

#include <algorithm>

namespace msf {

const PointSnapshot* PlaceWindow::FindPoint(MapPointId id) const {
  const auto place = std::lower_bound(
      points.begin(), points.end(), id,
      [](const PointSnapshot& point, MapPointId other) { return point.id < other; });
  return place != points.end() && place->id == id ? &*place : nullptr;
}

std::optional<PlaceWindow> CopyWindow(const Map& map, KeyFrameId centre, int num_neighbours) {
  const KeyFrame* keyframe = map.FindKeyFrame(centre);
  if (!keyframe || !keyframe->words) return std::nullopt;
  PlaceWindow window;
  window.map_id = keyframe->map_id;
  std::vector<KeyFrameId> ids = map.covisibility().Best(centre, num_neighbours);
  ids.insert(ids.begin(), centre);
  std::vector<MapPointId> point_ids;
  for (const KeyFrameId id : ids) {
    const KeyFrame& member = *map.FindKeyFrame(id);
    if (!member.words) continue;
    window.keyframes.push_back({id, member.T_cw, member.features, member.words, member.points});
    for (const MapPointId point : member.points) {
      if (point.valid()) point_ids.push_back(point);
    }
  }
  std::sort(point_ids.begin(), point_ids.end());
  point_ids.erase(std::unique(point_ids.begin(), point_ids.end()), point_ids.end());
  for (const MapPointId id : point_ids) window.points.emplace_back(*map.FindPoint(id));
  return window;
}

}  // namespace msf
