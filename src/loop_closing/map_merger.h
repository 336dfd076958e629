// Joins two maps that show the same place.
#pragma once

#include <optional>

#include "loop_closing/loop_closing_options.h"
#include "loop_closing/recognition.h"
#include "map/shared_map.h"

namespace msf {

struct MergeOutcome {
  MapId map_id;   // of both, from now on: the older one's
  int fused = 0;  // points that both had
};

// Brings the younger map into the older one's coordinates, fuses what both have around the
// recognised place, adjusts the seam on the younger map's side, and lets the rest of that map
// follow along its pose graph. Nothing when the keyframes of `place` are gone.
std::optional<MergeOutcome> MergeMaps(const LoopClosingOptions& options, const NoiseOptions& noise,
                                      const Recognition& place, SharedMap& map);

}  // namespace msf
