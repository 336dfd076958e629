// Bundle adjustment of a keyframe's neighbourhood.
#pragma once

#include <atomic>
#include <vector>

#include "map/map.h"
#include "mapping/mapping_options.h"

namespace msf {

// A piece of the map copied out for the solver, with the way back.
struct LocalBundle {
  BundleProblem problem;
  std::vector<KeyFrameId> keyframes;  // of problem.poses
  std::vector<MapPointId> points;     // of problem.points
  uint64_t epoch = 0;                 // of the map when it was copied
};

// `keyframe` and its best covisible keyframes move, with all points they see; everyone else who
// sees these points is fixed.
LocalBundle CopyLocalBundle(const MappingOptions& options, const NoiseOptions& noise,
                            const Map& map, KeyFrameId keyframe);

// Brings a solution into the map: poses, points, and observations that turned out to be outliers
// go. Nothing happens when the map was corrected as a whole since the copy was made.
void ApplyLocalBundle(const LocalBundle& bundle, const BundleResult& result, Map& map);

}  // namespace msf
