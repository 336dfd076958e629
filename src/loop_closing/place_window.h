// A keyframe and its neighbours as they were when copied: what two places are compared by, without
// the map's lock.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "map/map.h"
#include "matching/point_projection.h"

namespace msf {

// A keyframe of the window; what it saw is shared, its pose and points are copies.
struct KeyFrameView {
  KeyFrameId id;
  Rigid3d T_cw;
  std::shared_ptr<const FrameFeatures> features;
  std::shared_ptr<const BagOfWords> words;
  std::vector<MapPointId> points;  // per feature, invalid = none
};

struct PlaceWindow {
  MapId map_id;
  std::vector<KeyFrameView> keyframes;  // the centre first, then its best neighbours
  std::vector<PointSnapshot> points;    // all that they see, ascending by id

  const KeyFrameView& centre() const { return keyframes.front(); }
  // Null for a point that the window does not hold.
  const PointSnapshot* FindPoint(MapPointId id) const;
};

// `centre` with at most `num_neighbours` of its best covisible keyframes. Nothing when it is gone
// or has no words yet; neighbours without words are left out.
std::optional<PlaceWindow> CopyWindow(const Map& map, KeyFrameId centre, int num_neighbours);

}  // namespace msf
