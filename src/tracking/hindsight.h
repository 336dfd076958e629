// Where the frames were, once more: the map of the end knows its points better than that of the
// moment did, and points that came after a frame; and of the first frame it is known by then how
// fast the camera was.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "map/shared_map.h"
#include "tracking/local_map.h"
#include "tracking/pose_tracking.h"
#include "tracking/trajectory_recorder.h"

namespace msf {

// A frame as tracking left it.
struct TrackedFrame {
  FrameId id;
  double time_s = 0;
  std::shared_ptr<const FrameFeatures> features;  // a rolling shutter undone
  bool shutter_left_in = false;                   // or not: the velocity was not known
  std::vector<MapPointId> points;                 // per feature; invalid = none
  KeyFrameId reference;
  Rigid3d T_c_reference;
};

// Holds frames back until they are so much older than the newest one that mapping has made points
// of what they were the first to see.
class FrameDelay {
 public:
  explicit FrameDelay(double delay_s) : delay_s_(delay_s) {}
  // Frames in the order of time.
  void Add(TrackedFrame frame) { frames_.push_back(std::move(frame)); }
  // The frames that are due, oldest first.
  std::vector<TrackedFrame> TakeDue();
  std::vector<TrackedFrame> TakeAll();

 private:
  double delay_s_;
  std::deque<TrackedFrame> frames_;
};

// Single-threaded; others may read and change the map meanwhile.
class Hindsight {
 public:
  Hindsight(const TrackingContext& context, SharedMap& map) : context_(context), map_(map) {}

  // Finds the points of the map in a frame, among those around its place, and remembers where they
  // are; the frame's features are not kept. Frames come in the order of their ids. Of the newest
  // HindsightOptions::max_frames only. The first frame of a map, or after tracking was lost,
  // waits for the second: its rolling shutter is undone (tracking/first_frame.h), and if it is a
  // keyframe, that gets the features and the pose that come of it.
  void Match(const TrackedFrame& frame);

  // Gives the frames the poses that their sightings of points tell with the points where `map` has
  // them now. A frame keeps its pose when too few of them are left or agree.
  void Revise(const Map& map, std::vector<ResolvedFrame>& frames) const;
  // Frames that keep their poses because newer ones took their place.
  int num_left_out() const { return num_left_out_; }

 private:
  // Of a point, packed: a minute of video has a million of them.
  struct Sighting {
    int32_t point = 0;
    float u_px = 0, v_px = 0;
    float depth_m = 0;
    float weight = 0;  // static probability of feature and point at that time
    uint8_t level = 0;
  };
  struct Entry {
    FrameId id;
    std::vector<Sighting> sightings;
  };
  // Moves local_map_ to the frame, and says where that is; empty when its keyframe is gone.
  std::optional<Rigid3d> Approach(const Map& map, const TrackedFrame& frame);
  void MatchOne(const TrackedFrame& frame);
  void MatchFirst(const TrackedFrame& first, const TrackedFrame& second);
  void Remember(FrameId id, const FrameFeatures& features, const std::vector<PointMatch>& matches);
  // The sightings of points that are still in the map `id`, where they are now.
  std::vector<PoseObservation> Observe(const Entry& entry, const Map& map, MapId id) const;

  TrackingContext context_;
  SharedMap& map_;
  LocalMap local_map_;
  std::optional<TrackedFrame> first_;  // waits for the second
  std::deque<Entry> entries_;          // ascending by id
  int num_left_out_ = 0;
};

}  // namespace msf
