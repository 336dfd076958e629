#include "tracking/local_map.h"

#include <algorithm>
#include <set>

namespace msf {

void LocalMap::Clear() { *this = LocalMap(); }

void LocalMap::Update(const Map& map, const Frame& frame, int max_keyframes, int max_neighbours) {
  std::vector<KeyFrameId> keyframes = SelectKeyFrames(map, frame, max_keyframes, max_neighbours);
  if (keyframes.empty()) return;  // a frame without points leaves the former neighbourhood in place
  T_cw_best_keyframe_ = map.PoseOf(best_keyframe_);
  if (keyframes != keyframes_ || map_version_ != map.version()) {
    keyframes_ = std::move(keyframes);
    map_version_ = map.version();
    CopyPoints(map);
  } else if (map_weights_version_ != map.weights_version()) {
    for (PointSnapshot& point : points_)
      point.static_weight = map.FindPoint(point.id)->static_weight;
  }
  map_weights_version_ = map.weights_version();
}

std::vector<KeyFrameId> LocalMap::SelectKeyFrames(const Map& map, const Frame& frame,
                                                  int max_keyframes, int max_neighbours) {
  std::vector<int> votes;  // by keyframe id
  for (const MapPointId id : frame.points) {
    const MapPoint* point = map.FindPoint(id);
    if (!point) continue;
    for (const Observation& observation : point->observations) {
      const auto keyframe = static_cast<size_t>(observation.keyframe.value());
      if (keyframe >= votes.size()) votes.resize(keyframe + 1, 0);
      ++votes[keyframe];
    }
  }
  std::vector<std::pair<KeyFrameId, int>> ranked;
  for (size_t i = 0; i < votes.size(); ++i) {
    if (votes[i] > 0) ranked.emplace_back(KeyFrameId(static_cast<int64_t>(i)), votes[i]);
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  best_keyframe_ = ranked.empty() ? KeyFrameId() : ranked.front().first;
  if (ranked.size() > static_cast<size_t>(max_keyframes)) ranked.resize(max_keyframes);

  std::set<KeyFrameId> selected;
  for (const auto& [id, count] : ranked) selected.insert(id);
  const auto full = [&] { return static_cast<int>(selected.size()) >= max_keyframes; };
  for (const auto& [id, count] : ranked) {
    if (full()) break;
    // One new neighbour, child and parent each: the rim of the neighbourhood without running away.
    const auto add_first_new = [&](const auto& candidates) {
      for (const KeyFrameId candidate : candidates) {
        if (selected.insert(candidate).second) return;
      }
    };
    add_first_new(map.covisibility().Best(id, max_neighbours));
    add_first_new(map.tree().Children(id));
    if (map.tree().Parent(id).valid()) selected.insert(map.tree().Parent(id));
  }
  return {selected.begin(), selected.end()};
}

void LocalMap::CopyPoints(const Map& map) {
  const std::vector<MapPointId> ids = map.PointsSeenBy(keyframes_);
  points_.clear();
  points_.reserve(ids.size());
  for (const MapPointId id : ids) points_.emplace_back(*map.FindPoint(id));
}

}  // namespace msf
