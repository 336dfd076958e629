// The half of Map that deals with points.
#include <algorithm>
#include <bit>
#include <climits>
#include <cmath>

#include "map/map.h"
#include "util/check.h"

namespace msf {
namespace {

int Strength(const KeyFrame& keyframe, int feature) {
  return keyframe.features->HasDepth(feature) ? 2 : 1;
}

float LogOdds(float probability) {
  const float clamped = std::clamp(probability, 0.02f, 0.98f);
  return std::log(clamped / (1 - clamped));
}

}  // namespace

MapPointId Map::AddPoint(const Eigen::Vector3d& p_w, KeyFrameId first_keyframe, int feature) {
  ++version_;
  const KeyFrame& keyframe = MutableKeyFrame(first_keyframe);
  auto point = std::make_unique<MapPoint>();
  point->id = MapPointId(static_cast<int64_t>(points_.size()));
  point->map_id = keyframe.map_id;
  point->p_w = p_w;
  point->first_keyframe = point->reference = first_keyframe;
  point->descriptor = keyframe.features->descriptors[feature];
  point->static_weight = keyframe.features->static_weight[feature];
  point->color_bgr = keyframe.colors_bgr[feature];
  const MapPointId id = point->id;
  points_.push_back(std::move(point));
  replaced_by_.emplace_back();
  MSF_CHECK(AddObservation(id, first_keyframe, feature), "the feature of a new point is taken");
  UpdateNormalAndRange(id);
  return id;
}

const MapPoint* Map::FindPoint(MapPointId id) const {
  const bool known = id.valid() && id.value() < static_cast<int64_t>(points_.size());
  return known ? points_[id.value()].get() : nullptr;
}

MapPoint& Map::MutablePoint(MapPointId id) {
  MSF_CHECK(FindPoint(id) != nullptr, "this point is not in the map");
  return *points_[id.value()];
}

std::vector<MapPointId> Map::PointIds(MapId map) const {
  std::vector<MapPointId> ids;
  for (const auto& point : points_) {
    if (point && point->map_id == map) ids.push_back(point->id);
  }
  return ids;
}

int Map::NumPoints(MapId map) const {
  return static_cast<int>(std::count_if(points_.begin(), points_.end(), [&](const auto& point) {
    return point && point->map_id == map;
  }));
}

std::vector<MapPointId> Map::PointsSeenBy(std::span<const KeyFrameId> keyframes) const {
  // Neighbouring keyframes see the same points, tens of thousands in all: marking them is several
  // times faster than sorting. One bit per id, since an hour makes millions of ids.
  constexpr size_t kBits = 64;
  std::vector<uint64_t> is_seen(points_.size() / kBits + 1, 0);
  size_t count = 0;
  for (const KeyFrameId id : keyframes) {
    const KeyFrame* keyframe = FindKeyFrame(id);
    if (!keyframe) continue;
    for (const MapPointId point : keyframe->points) {
      if (!point.valid()) continue;
      const auto i = static_cast<size_t>(point.value());
      is_seen[i / kBits] |= uint64_t{1} << i % kBits;
      ++count;
    }
  }
  std::vector<MapPointId> seen;
  seen.reserve(count);
  for (size_t word = 0; word < is_seen.size(); ++word) {
    for (uint64_t left = is_seen[word]; left != 0; left &= left - 1)
      seen.emplace_back(static_cast<int64_t>(word * kBits + std::countr_zero(left)));
  }
  return seen;
}

void Map::SetPosition(MapPointId id, const Eigen::Vector3d& p_w) {
  ++version_;
  MutablePoint(id).p_w = p_w;
}

void Map::ObserveStaticProbability(MapPointId id, float probability) {
  constexpr float kRate = 0.1f;
  MapPoint& point = MutablePoint(id);
  if (probability >= 1 && point.static_weight >= 1) return;
  ++weights_version_;
  const float now = LogOdds(point.static_weight);
  const float updated = now + kRate * (LogOdds(probability) - now);
  point.static_weight = 1 / (1 + std::exp(-updated));
}

bool Map::AddObservation(MapPointId id, KeyFrameId keyframe_id, int feature) {
  MapPoint& point = MutablePoint(id);
  KeyFrame& keyframe = MutableKeyFrame(keyframe_id);
  if (keyframe.points[feature].valid()) return false;
  const auto place =
      std::lower_bound(point.observations.begin(), point.observations.end(), keyframe_id,
                       [](const Observation& observation, KeyFrameId other) {
                         return observation.keyframe < other;
                       });
  if (place != point.observations.end() && place->keyframe == keyframe_id) return false;
  ++version_;
  keyframe.points[feature] = id;
  point.observations.insert(place, {keyframe_id, feature});
  point.observation_strength += Strength(keyframe, feature);
  return true;
}

void Map::RemoveObservation(MapPointId id, KeyFrameId keyframe_id) {
  MapPoint& point = MutablePoint(id);
  const auto place = std::find_if(
      point.observations.begin(), point.observations.end(),
      [&](const Observation& observation) { return observation.keyframe == keyframe_id; });
  if (place == point.observations.end()) return;
  ++version_;
  KeyFrame& keyframe = MutableKeyFrame(keyframe_id);
  keyframe.points[place->feature] = MapPointId();
  point.observation_strength -= Strength(keyframe, place->feature);
  point.observations.erase(place);
  if (point.observations.size() < 2) {
    RemovePoint(id);
    return;
  }
  if (point.reference == keyframe_id) point.reference = point.observations.front().keyframe;
}

void Map::RemovePoint(MapPointId id) {
  ++version_;
  for (const Observation& observation : MutablePoint(id).observations) {
    MutableKeyFrame(observation.keyframe).points[observation.feature] = MapPointId();
  }
  points_[id.value()].reset();
}

void Map::ReplacePoint(MapPointId old_id, MapPointId new_id) {
  MSF_CHECK(old_id != new_id, "a point cannot replace itself");
  const MapPoint old_point = MutablePoint(old_id);
  RemovePoint(old_id);
  for (const Observation& observation : old_point.observations) {
    AddObservation(new_id, observation.keyframe, observation.feature);
  }
  CountVisible(new_id, old_point.visible_count);
  CountFound(new_id, old_point.found_count);
  replaced_by_[old_id.value()] = new_id;
  UpdateAppearance(new_id);
}

MapPointId Map::Resolve(MapPointId id) const {
  while (id.valid() && !FindPoint(id)) id = replaced_by_[id.value()];
  return id;
}

void Map::CountVisible(MapPointId id, int times) { MutablePoint(id).visible_count += times; }

void Map::CountFound(MapPointId id, int times) { MutablePoint(id).found_count += times; }

void Map::UpdateAppearance(MapPointId id) {
  MapPoint& point = MutablePoint(id);
  std::vector<Descriptor> descriptors;
  for (const Observation& observation : point.observations) {
    descriptors.push_back(
        FindKeyFrame(observation.keyframe)->features->descriptors[observation.feature]);
  }
  // The descriptor with the least median distance to the others stands for the point.
  int least_median = INT_MAX;
  std::vector<int> distances(descriptors.size());
  for (const Descriptor& candidate : descriptors) {
    std::transform(descriptors.begin(), descriptors.end(), distances.begin(),
                   [&](const Descriptor& other) { return DescriptorDistance(candidate, other); });
    const auto middle = distances.begin() + (distances.size() - 1) / 2;
    std::nth_element(distances.begin(), middle, distances.end());
    if (*middle >= least_median) continue;
    least_median = *middle;
    point.descriptor = candidate;
  }
}

void Map::UpdateNormalAndRange(MapPointId id) {
  MapPoint& point = MutablePoint(id);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Observation& observation : point.observations) {
    sum += (point.p_w - FindKeyFrame(observation.keyframe)->CentreInWorld()).normalized();
  }
  const KeyFrame& reference = *FindKeyFrame(point.reference);
  const int level = reference.features->level[point.FeatureIn(point.reference)];
  const double distance_m = (point.p_w - reference.CentreInWorld()).norm();
  point.normal = sum.normalized();
  point.max_distance_m = distance_m * levels_.scale(level);
  point.min_distance_m = point.max_distance_m / levels_.scale(levels_.size() - 1);
}

}  // namespace msf
