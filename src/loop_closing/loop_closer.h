// Loop closing from end to end: recognises places, closes loops and merges maps.
#pragma once

#include <optional>
#include <set>

#include "loop_closing/loop_detector.h"
#include "util/stage_timer.h"

namespace msf {

// What one keyframe brought.
struct LoopClosingSummary {
  std::optional<PlaceKind> found;      // a loop that was closed, or a merge that was made
  std::vector<PlaceAttempt> attempts;  // the candidates that were compared
  KeyFrameId current, matched;
  int inliers = 0;  // matches between the two that agree on one pose
  Rigid3d T_c_m;    // matched camera to current camera
  int fused_points = 0;
  // The map that was corrected and should be bundle-adjusted as a whole, see FullBundle.
  std::optional<MapId> wants_full_bundle;
  StageTimings timings_ms;
};

// Single-threaded; may run beside tracking and mapping, which share the map and the database.
class LoopCloser {
 public:
  LoopCloser(const LoopClosingOptions& options, const NoiseOptions& noise, SharedMap& map,
             KeyFrameDatabase& database, uint64_t seed);

  // Takes a keyframe that mapping is done with; to be called once per keyframe, in order. Makes it
  // known to the database (even when loop closing is off: relocalisation needs it), forgets those
  // that were culled, and closes the loop or merges the maps that the keyframe reveals.
  LoopClosingSummary Process(KeyFrameId id);

 private:
  void UpdateDatabase(KeyFrameId id);
  void Correct(const Recognition& place, LoopClosingSummary& summary);

  const LoopClosingOptions options_;
  const NoiseOptions noise_;
  SharedMap& map_;
  KeyFrameDatabase& database_;
  LoopDetector detector_;
  std::set<KeyFrameId> registered_;  // in the database
};

}  // namespace msf
