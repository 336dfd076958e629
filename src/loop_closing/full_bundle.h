// Bundle adjustment of a whole map, in the background.
#pragma once

#include <atomic>

#include "loop_closing/loop_closing_options.h"
#include "map/shared_map.h"
#include "optimization/feature_observation.h"

namespace msf {

class FullBundle {
 public:
  FullBundle(const LoopClosingOptions& options, const NoiseOptions& noise, SharedMap& map)
      : options_(options), noise_(noise), map_(map) {}

  // Copies the map, solves without holding it, and applies the solution; what joined the map
  // meanwhile moves along. False, and nothing happened, when `cancel` was set meanwhile, the map is
  // gone or too small, or it was corrected as a whole while the solver ran. May run on a thread of
  // its own beside everything else that shares the map.
  bool Run(MapId map_id, const std::atomic<bool>& cancel);

 private:
  const LoopClosingOptions options_;
  const NoiseOptions noise_;
  SharedMap& map_;
};

}  // namespace msf
