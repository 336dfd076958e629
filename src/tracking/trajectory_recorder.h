// Remembers every frame relative to its reference keyframe, so that later corrections of the map
// reach it.
#pragma once

#include <optional>
#include <vector>

#include "map/map.h"
#include "tracking/tracking_result.h"

namespace msf {

// Where a frame was in the end.
struct ResolvedFrame {
  FrameId frame_id;
  double time_s = 0;
  TrackingState state = TrackingState::kInitialising;
  std::optional<Rigid3d> T_wc;  // empty: no pose, or its map was dropped
  MapId map_id;
};

// Whether the motion between two frames that follow each other tells about that within them: both
// have a pose in the same map, and at most half a second lies between.
bool AreNeighbours(const ResolvedFrame& a, const ResolvedFrame& b);

class TrajectoryRecorder {
 public:
  void Record(const TrackingResult& result);
  // One entry per recorded frame, in their order, with the keyframes' poses of this moment.
  std::vector<ResolvedFrame> Resolve(const Map& map) const;

 private:
  struct Entry {
    FrameId frame_id;
    double time_s = 0;
    TrackingState state = TrackingState::kInitialising;
    KeyFrameId reference;  // invalid without a pose
    Rigid3d T_c_reference;
  };
  std::vector<Entry> entries_;
};

}  // namespace msf
