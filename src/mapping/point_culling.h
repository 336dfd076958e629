// Young points must prove themselves, or go.
#pragma once

#include <vector>

#include "map/map.h"
#include "mapping/mapping_options.h"

namespace msf {

class RecentPoints {
 public:
  void Add(MapPointId id) { points_.push_back(id); }
  // Removes from the map the points that are found too rarely, or still have too few observers two
  // keyframes later; after three keyframes a point is established and no longer looked at.
  void Cull(const MappingOptions& options, KeyFrameId newest, Map& map);

 private:
  std::vector<MapPointId> points_;
};

// Removes the points in view of `keyframe` and its best `options.num_neighbours` neighbours that do
// not stand still: their static probability has fallen below `options.min_static_probability`.
// Returns how many.
int CullMovingPoints(const MappingOptions& options, KeyFrameId keyframe, Map& map);

}  // namespace msf
