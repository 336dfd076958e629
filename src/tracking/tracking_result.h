// What tracking says about one frame.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "feature/frame_features.h"
#include "feature/landmark.h"
#include "geometry/rigid3d.h"
#include "util/stage_timer.h"
#include "util/strong_id.h"

namespace msf {

enum class TrackingState {
  kInitialising,  // no map yet
  kTracking,      // pose known
  kRecentlyLost,  // pose unknown for a short while: relocalisation is tried
  kLost,          // given up on the present map: the next good frame starts a new one
};

const char* ToString(TrackingState state);

struct TrackingResult {
  FrameId frame_id;
  double time_s = 0;
  TrackingState state = TrackingState::kInitialising;
  std::optional<Rigid3d>
      T_cw;  // world to camera, in the coordinates of map_id at this moment; empty without a pose
  MapId map_id;
  uint64_t epoch = 0;  // Map::epoch() of these coordinates
  int num_features = 0;
  int num_inliers = 0;              // map points that agree with the pose
  std::vector<int> readmitted;      // of the removed features, those that are used after all
  std::vector<Landmark> landmarks;  // what the frame shows of the map's trusted part
  KeyFrameId reference;
  Rigid3d T_c_reference;
  std::shared_ptr<const FrameFeatures> features;  // those that were used, a rolling shutter undone
  bool shutter_left_in = false;                   // or not: the velocity was not known
  std::vector<MapPointId> points;                 // per feature: the map point it shows, if any
  bool started_map = false;                       // this frame is the first of a new map
  std::optional<KeyFrameId> new_keyframe;         // this frame became a keyframe
  StageTimings timings_ms;
};

}  // namespace msf
