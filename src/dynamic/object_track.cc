#include "dynamic/object_track.h"

#include <algorithm>

namespace msf {
namespace {

constexpr int kConfirmationsOfAMover = 2;
constexpr double kUncertainShare = 1.0 / 3;  // of settle_s: a resting object is uncertain after that

// Share of the smaller box that lies in the other: a person cut by the border shrinks to a part of itself.
float Containment(const ImageBox& a, const ImageBox& b) {
  const ImageBox common{std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
  const float smaller = std::min(a.area(), b.area());
  return smaller > 0 ? common.area() / smaller : 0;
}

}  // namespace

const char* ToString(MotionState state) {
  switch (state) {
    case MotionState::kMoving: return "moving";
    case MotionState::kUncertain: return "uncertain";
    case MotionState::kStatic: return "static";
  }
  return "unknown";
}

bool ObjectTrack::Removes() const {
  switch (kind) {
    case ObjectKind::kKnown: return state != MotionState::kStatic;
    case ObjectKind::kPotential: return state == MotionState::kMoving;
    case ObjectKind::kUnknown: return confirmations >= kConfirmationsOfAMover && state != MotionState::kStatic;
  }
  return false;
}

std::optional<ImageBox> ObjectTrack::BoxAt(FrameId frame) const {
  for (const auto& [id, past] : past_boxes) {
    if (id == frame) return past;
  }
  return std::nullopt;
}

ObjectTrack* ObjectTracks::FindMatch(const Detection& detection, ObjectKind kind, const std::vector<uint8_t>& taken) {
  constexpr float kMostlyInside = 0.7f;
  ObjectTrack* best = nullptr;
  float best_overlap = 0;
  for (size_t t = 0; t < taken.size(); ++t) {
    ObjectTrack& track = tracks_[t];
    // A mover of unknown class may turn out to be of a known one.
    if (taken[t] || (track.kind != kind && track.kind != ObjectKind::kUnknown)) continue;
    const float iou = IntersectionOverUnion(detection.box, track.box);
    const float contained = Containment(detection.box, track.box);
    if (iou < options_.min_iou && contained < kMostlyInside) continue;
    const float overlap = iou + 0.1f * contained;
    if (overlap > best_overlap) {
      best_overlap = overlap;
      best = &track;
    }
  }
  return best;
}

void ObjectTracks::TakeDetections(const std::vector<Detection>& detections, double time_s) {
  std::vector<uint8_t> taken(tracks_.size(), 0);
  std::vector<ObjectTrack> started;
  for (const Detection& detection : detections) {
    const std::optional<ObjectKind> kind = roles_.KindOf(detection.class_id);
    if (!kind || detection.score < options_.continue_score) continue;
    ObjectTrack* track = FindMatch(detection, *kind, taken);
    if (track) {
      taken[track - tracks_.data()] = 1;
    } else {
      const double needed = *kind == ObjectKind::kKnown ? options_.start_score : options_.potential_score;
      if (detection.score < needed) continue;
      ObjectTrack& fresh = started.emplace_back();
      fresh.id = next_id_++;
      fresh.state = *kind == ObjectKind::kKnown ? MotionState::kMoving : MotionState::kUncertain;
      fresh.resting_since_s = time_s;
      track = &fresh;
    }
    track->kind = *kind;
    track->class_id = detection.class_id;
    track->score = detection.score;
    track->box = detection.box;
    track->confirmed_s = time_s;
    ++track->confirmations;
  }
  tracks_.insert(tracks_.end(), std::make_move_iterator(started.begin()), std::make_move_iterator(started.end()));
}

void ObjectTracks::TakeMover(const ImageBox& box, ObjectMask mask, double time_s) {
  ObjectTrack* track = nullptr;
  for (ObjectTrack& other : tracks_) {
    if (other.kind != ObjectKind::kUnknown) continue;
    if (IntersectionOverUnion(box, other.box) >= options_.min_iou || Containment(box, other.box) > 0.5f) track = &other;
  }
  if (!track) {
    track = &tracks_.emplace_back();
    track->id = next_id_++;
  }
  track->box = box;
  track->mask = std::move(mask);
  track->state = MotionState::kMoving;
  track->confirmed_s = track->resting_since_s = time_s;
  ++track->confirmations;
}

void ObjectTracks::UpdateState(ObjectTrack& track, double time_s) const {
  const MotionEvidence& evidence = track.evidence;
  if (evidence.tested < options_.min_tested_points) {
    // No verdict: what is not known to rest does not begin to.
    if (track.state != MotionState::kStatic) track.resting_since_s = time_s;
    return;
  }
  const double share = evidence.MovingShare();
  if (share >= options_.moving_share) {
    track.state = MotionState::kMoving;
    track.resting_since_s = time_s;
    if (track.kind == ObjectKind::kUnknown || track.confirmations > 2) track.confirmed_s = time_s;
    return;
  }
  if (share > options_.settled_share) {
    if (track.state != MotionState::kStatic) track.resting_since_s = time_s;
    return;
  }
  const double resting_s = time_s - track.resting_since_s;
  if (resting_s > options_.settle_s) {
    track.state = MotionState::kStatic;
  } else if (resting_s > kUncertainShare * options_.settle_s && track.state == MotionState::kMoving) {
    track.state = MotionState::kUncertain;
  }
}

void ObjectTracks::UpdateStates(double time_s) {
  for (ObjectTrack& track : tracks_) UpdateState(track, time_s);
}

void ObjectTracks::DropLost(double time_s, double bridge_s) {
  std::erase_if(tracks_, [&](const ObjectTrack& track) { return time_s - track.confirmed_s > bridge_s; });
}

void ObjectTracks::RememberBoxes(FrameId frame, size_t max_history) {
  for (ObjectTrack& track : tracks_) {
    track.past_boxes.emplace_back(frame, track.box);
    if (track.past_boxes.size() > max_history) track.past_boxes.pop_front();
  }
}

}  // namespace msf
