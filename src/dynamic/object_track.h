// Objects that move or may move, followed from image to image.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dynamic/class_roles.h"
#include "dynamic/object_mask.h"

namespace msf {

enum class MotionState { kMoving, kUncertain, kStatic };
const char* ToString(MotionState state);

// What the motion test says about the points of an object.
struct MotionEvidence {
  int tested = 0;
  int moving = 0;
  int blocks = 0;      // of its mask
  int new_blocks = 0;  // of them, those through which the camera has seen before
  double MovingShare() const { return tested > 0 ? static_cast<double>(moving) / tested : 0; }
  // Whether this image by itself shows that it moves.
  bool SpeaksForMotion() const { return MovingShare() >= 0.35 || NewShare() >= 0.2; }
  double NewShare() const { return blocks > 0 ? static_cast<double>(new_blocks) / blocks : 0; }
};

struct ObjectTrack {
  int id = 0;
  int class_id = -1;  // of the detector; -1: a mover of unknown class
  ObjectKind kind = ObjectKind::kUnknown;
  float score = 0;       // of the last detection
  float best_score = 0;  // of all
  ImageBox box;          // in the present image, px
  ObjectMask mask;
  MotionState state = MotionState::kMoving;
  Eigen::Vector2f own_velocity_px_s =
      Eigen::Vector2f::Zero();  // beyond what the camera's motion does to it
  double confirmed_s = 0;       // last detection, or last time its motion was seen
  double seen_well_s = 0;       // last detection that could have started it, or motion
  double detection_age_s = 0;   // of the last detection when it came
  double resting_since_s = 0;
  int confirmations = 0;  // images in which it was detected or seen to move
  MotionEvidence evidence;
  int detected_area = 0;       // of the mask when it was detected last, cells
  float detected_depth_m = 0;  // and its depth
  std::deque<std::pair<FrameId, ImageBox>> past_boxes;  // newest last

  // Whether its points are to be removed; a mover of unknown class must have been seen three times.
  bool Removes() const;
  std::optional<ImageBox> BoxAt(FrameId frame) const;
};

// Associates detections with tracks and keeps each track's state of motion.
class ObjectTracks {
 public:
  ObjectTracks(const ObjectTrackOptions& options, ClassRoles roles)
      : options_(options), roles_(std::move(roles)) {}

  const std::vector<ObjectTrack>& tracks() const { return tracks_; }
  std::vector<ObjectTrack>& tracks() { return tracks_; }
  const ClassRoles& roles() const { return roles_; }

  // Boxes in pixels of the present image; best first. A box continues the track of its kind that it
  // overlaps most; what is left starts new tracks where the score allows it. `age_s`: of the image
  // in which they were found.
  void TakeDetections(const std::vector<Detection>& detections, double time_s, double age_s = 0);
  // Whether TakeDetections() could use one that belongs to the image `frame`.
  bool MayTake(const Detection& detection, FrameId frame) const;
  // A cluster of moving points outside all masks: confirms and extends the mover there at its
  // depth, or starts one.
  void TakeMover(const ObjectMask& mask, double time_s);
  // Movers of unknown class that cover each other at the same depth are one, the older one.
  void MergeMovers();
  // The state of motion after `track.evidence` was filled.
  void UpdateStates(double time_s);
  // Forgets tracks that nothing has confirmed for a while; without bridging at once.
  void DropLost(double time_s, bool bridging);
  void RememberBoxes(FrameId frame, size_t max_history);

 private:
  ObjectTrack* FindMatch(const Detection& detection, ObjectKind kind,
                         const std::vector<uint8_t>& taken);
  double BridgeOf(const ObjectTrack& track) const;
  void UpdateState(ObjectTrack& track, double time_s) const;

  ObjectTrackOptions options_;
  ClassRoles roles_;
  std::vector<ObjectTrack> tracks_;
  int next_id_ = 0;
};

}  // namespace msf
