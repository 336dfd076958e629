#include "map/map.h"

#include <algorithm>

#include "util/check.h"

namespace msf {
namespace {

// Keyframes with fewer shared points are no neighbours (unless there is no better one).
constexpr int kMinSharedPoints = 15;

template <typename T, typename Id>
T* At(const std::vector<std::unique_ptr<T>>& items, Id id) {
  const bool known = id.valid() && id.value() < static_cast<int64_t>(items.size());
  return known ? items[id.value()].get() : nullptr;
}

template <typename Id, typename T>
std::vector<Id> IdsOf(const std::vector<std::unique_ptr<T>>& items, MapId map) {
  std::vector<Id> ids;
  for (const auto& item : items) {
    if (item && item->map_id == map) ids.push_back(item->id);
  }
  return ids;
}

template <typename T>
int CountOf(const std::vector<std::unique_ptr<T>>& items, MapId map) {
  return static_cast<int>(std::count_if(
      items.begin(), items.end(), [&](const auto& item) { return item && item->map_id == map; }));
}

}  // namespace

// --- Atlas

MapId Map::StartNewMap() {
  ++version_;
  return active_map_ = MapId(num_maps_++);
}

void Map::DropMap(MapId id) {
  ++version_;
  for (const MapPointId point : PointIds(id)) points_[point.value()].reset();
  for (const KeyFrameId keyframe : KeyFrameIds(id)) {
    covisibility_.Remove(keyframe);
    tree_.Remove(keyframe, [](KeyFrameId, KeyFrameId) { return 0; });
    keyframes_[keyframe.value()].reset();
  }
}

void Map::MoveMap(MapId from, MapId to, const Rigid3d& T_to_from) {
  ++version_;
  const Rigid3d T_from_to = T_to_from.Inverse();
  for (const auto& keyframe : keyframes_) {
    if (!keyframe || keyframe->map_id != from) continue;
    keyframe->T_cw = keyframe->T_cw * T_from_to;
    keyframe->map_id = to;
  }
  for (const auto& point : points_) {
    if (!point || point->map_id != from) continue;
    MovePoint(point->id, T_to_from);
    point->map_id = to;
  }
  if (active_map_ == from) active_map_ = to;
}

void Map::MovePoint(MapPointId id, const Rigid3d& motion) {
  ++version_;
  MapPoint& point = MutablePoint(id);
  point.p_w = motion * point.p_w;
  point.normal = motion.rotation() * point.normal;
}

std::vector<MapId> Map::MapIds() const {
  std::vector<MapId> ids;
  for (const auto& keyframe : keyframes_) {
    if (keyframe) ids.push_back(keyframe->map_id);
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

// --- Keyframes

KeyFrameId Map::AddKeyFrame(KeyFrame keyframe) {
  MSF_CHECK(active_map_.valid(), "a keyframe needs a map: StartNewMap() first");
  ++version_;
  const KeyFrameId id(static_cast<int64_t>(keyframes_.size()));
  keyframe.id = id;
  keyframe.map_id = active_map_;
  keyframe.points.assign(keyframe.features->size(), MapPointId());
  keyframes_.push_back(std::make_unique<KeyFrame>(std::move(keyframe)));
  culled_.emplace_back();
  return id;
}

const KeyFrame* Map::FindKeyFrame(KeyFrameId id) const { return At(keyframes_, id); }

const Map::CulledKeyFrame* Map::FindCulled(KeyFrameId id) const { return At(culled_, id); }

KeyFrame& Map::MutableKeyFrame(KeyFrameId id) {
  KeyFrame* keyframe = At(keyframes_, id);
  MSF_CHECK(keyframe != nullptr, "this keyframe is not in the map");
  return *keyframe;
}

std::vector<KeyFrameId> Map::KeyFrameIds(MapId map) const {
  return IdsOf<KeyFrameId>(keyframes_, map);
}

std::vector<KeyFrameId> Map::KeyFrameIds() const {
  std::vector<KeyFrameId> ids;
  for (const auto& keyframe : keyframes_) {
    if (keyframe) ids.push_back(keyframe->id);
  }
  return ids;
}

int Map::NumKeyFrames(MapId map) const { return CountOf(keyframes_, map); }

void Map::SetFeatures(KeyFrameId id, std::shared_ptr<const FrameFeatures> features) {
  ++version_;
  KeyFrame& keyframe = MutableKeyFrame(id);
  MSF_CHECK(features->size() == keyframe.features->size(), "features keep their order");
  keyframe.features = std::move(features);
}

void Map::SetPose(KeyFrameId id, const Rigid3d& T_cw) {
  ++version_;
  MutableKeyFrame(id).T_cw = T_cw;
}

const KeyFrame* Map::Carrier(KeyFrameId id) const {
  while (const CulledKeyFrame* culled = FindCulled(id)) id = culled->attached_to;
  return FindKeyFrame(id);
}

Rigid3d Map::PoseOf(KeyFrameId id) const {
  MSF_CHECK(Knows(id), "the map of this keyframe was dropped");
  Rigid3d T_c_carrier;
  while (const CulledKeyFrame* culled = FindCulled(id)) {
    T_c_carrier = T_c_carrier * culled->T_c_attached;
    id = culled->attached_to;
  }
  return T_c_carrier * FindKeyFrame(id)->T_cw;
}

void Map::CullKeyFrame(KeyFrameId id) {
  ++version_;
  KeyFrame& keyframe = MutableKeyFrame(id);
  KeyFrameId heir = tree_.Parent(id);
  if (!heir.valid()) {
    MSF_CHECK(!tree_.Children(id).empty(), "the last keyframe of a map cannot be culled");
    heir = *tree_.Children(id).begin();
  }
  auto culled = std::make_unique<CulledKeyFrame>();
  culled->attached_to = heir;
  culled->T_c_attached = keyframe.T_cw * FindKeyFrame(heir)->T_cw.Inverse();
  for (const MapPointId point : std::vector<MapPointId>(keyframe.points)) {
    if (point.valid()) RemoveObservation(point, id);
  }
  tree_.Remove(id, [this](KeyFrameId a, KeyFrameId b) { return covisibility_.Weight(a, b); });
  covisibility_.Remove(id);
  keyframes_[id.value()].reset();
  culled_[id.value()] = std::move(culled);
}

void Map::SetWords(KeyFrameId id, std::shared_ptr<const BagOfWords> words) {
  MutableKeyFrame(id).words = std::move(words);
}

bool Map::Knows(KeyFrameId id) const { return Carrier(id) != nullptr; }

MapId Map::MapOf(KeyFrameId id) const {
  const KeyFrame* carrier = Carrier(id);
  return carrier ? carrier->map_id : MapId();
}

// --- Graphs

KeyFrameId Map::Predecessor(const KeyFrame& keyframe) const {
  for (int64_t value = keyframe.id.value() - 1; value >= 0; --value) {
    const KeyFrame* other = FindKeyFrame(KeyFrameId(value));
    if (other && other->map_id == keyframe.map_id && tree_.Contains(other->id)) return other->id;
  }
  return KeyFrameId();
}

void Map::UpdateConnections(KeyFrameId id) {
  ++version_;
  const KeyFrame& keyframe = MutableKeyFrame(id);
  std::map<KeyFrameId, int> shared;
  for (const MapPointId point : keyframe.points) {
    if (!point.valid()) continue;
    for (const Observation& observation : FindPoint(point)->observations) {
      if (observation.keyframe != id) ++shared[observation.keyframe];
    }
  }
  KeyFrameId best;
  for (const auto& [other, count] : shared) {
    if (!best.valid() || count > shared[best]) best = other;
  }
  std::map<KeyFrameId, int> strong;
  for (const auto& [other, count] : shared) {
    if (count >= kMinSharedPoints || other == best) strong[other] = count;
  }
  covisibility_.SetEdges(id, strong);
  if (!tree_.Contains(id)) tree_.Add(id, best.valid() ? best : Predecessor(keyframe));
}

}  // namespace msf
