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
  std::erase_if(ids, [&](KeyFrameId id) { return !map.FindKeyFrame(id)->words; });
  for (const KeyFrameId id : ids) {
    const KeyFrame& member = *map.FindKeyFrame(id);
    window.keyframes.push_back({id, member.T_cw, member.features, member.words, member.points});
  }
  for (const MapPointId id : map.PointsSeenBy(ids)) window.points.emplace_back(*map.FindPoint(id));
  return window;
}

}  // namespace msf
