// Keyframes that tell nothing new go.
#pragma once

#include "map/map.h"
#include "mapping/mapping_options.h"

namespace msf {

// Culls the neighbours of `around` whose close points are almost all seen by several other
// keyframes, at most one level coarser. The root of the tree and ends of loops stay. Returns
// those that went.
std::vector<KeyFrameId> CullRedundantKeyFrames(const MappingOptions& options, KeyFrameId around,
                                               Map& map);

}  // namespace msf
