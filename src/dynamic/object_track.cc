#include "dynamic/object_track.h"

#include <algorithm>
#include <cmath>

namespace msf {
namespace {

constexpr int kConfirmationsOfAMover = 3;
constexpr double kUncertainShare =
    1.0 / 3;  // of settle_s: a resting object is uncertain after that

// Share of the smaller box that lies in the other: a person cut by the border shrinks to a part of
// itself.
float Containment(const ImageBox& a, const ImageBox& b) {
  const ImageBox common{std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1),
                        std::min(a.y1, b.y1)};
  const float smaller = std::min(a.area(), b.area());
  return smaller > 0 ? common.area() / smaller : 0;
}

// A mask whose depth is not known may be at any.
bool AtSimilarDepth(const ObjectMask& a, const ObjectMask& b) {
  constexpr float kSimilar_m = 0.3f;
  return a.depth_m <= 0 || b.depth_m <= 0 || std::abs(a.depth_m - b.depth_m) <= kSimilar_m;
}

// The same thing found twice: a second box of whatever class around it.
bool IsEcho(const ImageBox& box, float score, const ObjectTrack& track) {
  constexpr float kSameBox = 0.5f, kInside = 0.8f, kMuchWeaker = 0.7f;
  if (track.score < score) return false;
  if (IntersectionOverUnion(box, track.box) > kSameBox) return true;
  return score < kMuchWeaker * track.score && Containment(box, track.box) > kInside;
}

}  // namespace

const char* ToString(MotionState state) {
  switch (state) {
    case MotionState::kMoving:
      return "moving";
    case MotionState::kUncertain:
      return "uncertain";
    case MotionState::kStatic:
      return "static";
  }
  return "unknown";
}

bool ObjectTrack::Removes() const {
  switch (kind) {
    case ObjectKind::kKnown:
      return state != MotionState::kStatic;
    case ObjectKind::kPotential:
      return state == MotionState::kMoving;
    case ObjectKind::kUnknown:
      return confirmations >= kConfirmationsOfAMover &&
             (state == MotionState::kMoving ||
              (state == MotionState::kUncertain && evidence.SpeaksForMotion()));
  }
  return false;
}

std::optional<ImageBox> ObjectTrack::BoxAt(FrameId frame) const {
  for (const auto& [id, past] : past_boxes) {
    if (id == frame) return past;
  }
  return std::nullopt;
}

ObjectTrack* ObjectTracks::FindMatch(const Detection& detection, ObjectKind kind,
                                     const std::vector<uint8_t>& taken) {
  constexpr float kMostlyInside = 0.7f, kSameBox = 0.5f;
  const double start_score = roles_.StartScoreOf(detection.class_id);
  ObjectTrack* best = nullptr;
  float best_overlap = 0;
  for (size_t t = 0; t < taken.size(); ++t) {
    ObjectTrack& track = tracks_[t];
    // A mover of unknown class may turn out to be of a known one.
    const bool may_turn_out = track.kind == ObjectKind::kUnknown && detection.score >= start_score;
    if (taken[t] || (track.kind != kind && !may_turn_out)) continue;
    const float iou = IntersectionOverUnion(detection.box, track.box);
    const float contained = Containment(detection.box, track.box);
    // A weak detection, or one of another class, must look like the object itself.
    const bool same_class = track.class_id < 0 || track.class_id == detection.class_id;
    const bool weak = detection.score < start_score;
    if (weak && !same_class) continue;
    if (weak || !same_class ? iou < kSameBox : iou < options_.min_iou && contained < kMostlyInside)
      continue;
    const float overlap = iou + 0.1f * contained;
    if (overlap > best_overlap) {
      best_overlap = overlap;
      best = &track;
    }
  }
  return best;
}

bool ObjectTracks::MayTake(const Detection& detection, FrameId frame) const {
  const std::optional<ObjectKind> kind = roles_.KindOf(detection.class_id);
  if (!kind || detection.score < options_.continue_score) return false;
  if (detection.score >= roles_.StartScoreOf(detection.class_id)) return true;
  return std::any_of(tracks_.begin(), tracks_.end(), [&](const ObjectTrack& track) {
    const ImageBox box = track.BoxAt(frame).value_or(track.box);
    return track.kind == *kind && IntersectionOverUnion(detection.box, box) > 0;
  });
}

void ObjectTracks::TakeDetections(const std::vector<Detection>& detections, double time_s,
                                  double age_s) {
  std::vector<uint8_t> taken(tracks_.size(), 0);
  const auto any_taken = [&](auto such) {
    for (size_t t = 0; t < taken.size(); ++t) {
      if (taken[t] && such(tracks_[t])) return true;
    }
    return false;
  };
  for (const Detection& detection : detections) {
    const std::optional<ObjectKind> kind = roles_.KindOf(detection.class_id);
    if (!kind || detection.score < options_.continue_score) continue;
    // Somebody who sits on a chair is no echo of it.
    constexpr float kHalfAsSure = 0.5f;
    const bool is_echo = any_taken([&](const ObjectTrack& track) {
      const bool sits_on_it = *kind == ObjectKind::kKnown && track.kind == ObjectKind::kPotential &&
                              detection.score >= kHalfAsSure * track.score;
      return !sits_on_it && IsEcho(detection.box, detection.score, track);
    });
    if (is_echo) continue;
    ObjectTrack* track = FindMatch(detection, *kind, taken);
    if (!track) {
      if (detection.score < roles_.StartScoreOf(detection.class_id)) continue;
      track = &tracks_.emplace_back();
      track->id = next_id_++;
      taken.push_back(0);
    }
    if (detection.score >= roles_.StartScoreOf(detection.class_id)) track->seen_well_s = time_s;
    // Clutter gets weak detections, too.
    if (time_s - track->seen_well_s > options_.weak_s) continue;
    taken[track - tracks_.data()] = 1;
    const bool turns_out_alive = track->kind == ObjectKind::kUnknown && *kind == ObjectKind::kKnown;
    if (track->confirmations == 0 || turns_out_alive) {
      track->state = *kind == ObjectKind::kKnown ? MotionState::kMoving : MotionState::kUncertain;
      track->resting_since_s = time_s;
    }
    track->kind = *kind;
    track->class_id = detection.class_id;
    track->score = detection.score;
    track->best_score = std::max(track->best_score, detection.score);
    track->box = detection.box;
    track->confirmed_s = time_s;
    track->detection_age_s = age_s;
    ++track->confirmations;
  }
  // A track that only bridges where another one was detected has been mistaken.
  for (size_t t = 0; t < taken.size(); ++t) {
    const ObjectTrack& bridged = tracks_[t];
    const bool is_echo = !taken[t] && any_taken([&](const ObjectTrack& track) {
      return AtSimilarDepth(bridged.mask, track.mask) && IsEcho(bridged.box, 0, track);
    });
    if (is_echo) tracks_[t].confirmed_s = -1e9;
  }
}

void ObjectTracks::TakeMover(const ObjectMask& mask, double time_s) {
  ObjectTrack* track = nullptr;
  for (ObjectTrack& other : tracks_) {
    if (other.kind != ObjectKind::kUnknown || !AtSimilarDepth(other.mask, mask)) continue;
    if (IntersectionOverUnion(mask.box, other.box) >= options_.min_iou ||
        Containment(mask.box, other.box) > 0.5f)
      track = &other;
  }
  if (!track) {
    track = &tracks_.emplace_back();
    track->id = next_id_++;
  }
  // Several clusters of one image are one confirmation.
  if (track->confirmations == 0 || track->confirmed_s < time_s) ++track->confirmations;
  track->mask = Union(track->mask, mask);
  track->box = track->mask.box;
  track->state = MotionState::kMoving;
  track->confirmed_s = track->resting_since_s = time_s;
}

void ObjectTracks::MergeMovers() {
  constexpr float kMostlyInside = 0.7f;
  std::vector<uint8_t> merged(tracks_.size(), 0);
  for (size_t a = 0; a < tracks_.size(); ++a) {
    for (size_t b = a + 1; b < tracks_.size(); ++b) {
      ObjectTrack& one = tracks_[a];
      const ObjectTrack& other = tracks_[b];
      if (merged[a] || merged[b] || one.kind != ObjectKind::kUnknown ||
          other.kind != ObjectKind::kUnknown || one.mask.empty() || other.mask.empty())
        continue;
      const bool same_place = Containment(one.mask.box, other.mask.box) > kMostlyInside;
      if (!same_place || !AtSimilarDepth(one.mask, other.mask)) continue;
      if (other.mask.area > one.mask.area) {
        one.mask = other.mask;
        one.box = other.box;
      }
      one.confirmations = std::max(one.confirmations, other.confirmations);
      one.confirmed_s = std::max(one.confirmed_s, other.confirmed_s);
      one.resting_since_s = std::max(one.resting_since_s, other.resting_since_s);
      merged[b] = 1;
    }
  }
  size_t kept = 0;
  for (size_t t = 0; t < tracks_.size(); ++t) {
    if (merged[t]) continue;
    if (kept != t) tracks_[kept] = std::move(tracks_[t]);
    ++kept;
  }
  tracks_.resize(kept);
}

void ObjectTracks::UpdateState(ObjectTrack& track, double time_s) const {
  const MotionEvidence& evidence = track.evidence;
  if (evidence.NewShare() > options_.new_share) {
    track.state = MotionState::kMoving;
    track.confirmed_s = track.seen_well_s = track.resting_since_s = time_s;
    return;
  }
  if (evidence.tested < options_.min_tested_points) {
    // No verdict: what is not known to rest does not begin to.
    if (track.state != MotionState::kStatic) track.resting_since_s = time_s;
    return;
  }
  const double share = evidence.MovingShare();
  const bool known = track.kind == ObjectKind::kKnown;
  if (share >= options_.mover_share) track.confirmed_s = track.seen_well_s = time_s;
  if (share >= (known ? options_.moving_share : options_.mover_share)) {
    track.state = MotionState::kMoving;
    track.resting_since_s = time_s;
    return;
  }
  // Between the two shares a person is neither: what does not rest yet does not begin to.
  if (known && share > options_.settled_share) {
    if (track.state != MotionState::kStatic) track.resting_since_s = time_s;
    return;
  }
  const double settle_s = known ? options_.settle_s : options_.mover_settle_s;
  const double resting_s = time_s - track.resting_since_s;
  if (resting_s > settle_s) {
    track.state = MotionState::kStatic;
  } else if (resting_s > kUncertainShare * settle_s && track.state == MotionState::kMoving) {
    track.state = MotionState::kUncertain;
  }
}

void ObjectTracks::UpdateStates(double time_s) {
  for (ObjectTrack& track : tracks_) UpdateState(track, time_s);
}

double ObjectTracks::BridgeOf(const ObjectTrack& track) const {
  constexpr int kOften = 10;
  constexpr float kSameDepth_m = 0.25f;
  const bool same_area =
      2 * track.mask.area > track.detected_area && track.mask.area < 2 * track.detected_area;
  const bool same_depth = std::abs(track.mask.depth_m - track.detected_depth_m) < kSameDepth_m;
  const bool still_there =
      track.kind == ObjectKind::kKnown && track.confirmations >= kOften && same_area && same_depth;
  if (still_there) return options_.bridge_still_s;
  if (track.kind == ObjectKind::kUnknown || track.best_score >= options_.sure_score)
    return options_.bridge_s;
  // The next one may come as late as this one did.
  const double earned_s =
      track.detection_age_s + options_.bridge_per_detection_s * track.confirmations;
  return std::min(options_.bridge_s, earned_s);
}

void ObjectTracks::DropLost(double time_s, bool bridging) {
  for (ObjectTrack& track : tracks_) {
    if (track.confirmed_s < time_s) continue;
    track.detected_area = track.mask.area;
    track.detected_depth_m = track.mask.depth_m;
  }
  constexpr int kSmallestMover = 12;  // cells
  std::erase_if(tracks_, [&](const ObjectTrack& track) {
    const bool vanished = track.kind == ObjectKind::kUnknown && track.mask.area < kSmallestMover;
    return vanished || time_s - track.confirmed_s > (bridging ? BridgeOf(track) : 0);
  });
}

void ObjectTracks::RememberBoxes(FrameId frame, size_t max_history) {
  for (ObjectTrack& track : tracks_) {
    track.past_boxes.emplace_back(frame, track.box);
    if (track.past_boxes.size() > max_history) track.past_boxes.pop_front();
  }
}

}  // namespace msf
