#include "loop_closing/loop_detector.h"

#include <algorithm>
#include <set>

namespace msf {
namespace {

// What verification needs besides the windows, without the map's lock.
struct VerificationContext {
  explicit VerificationContext(const Map& map) : camera(map.camera()), levels(map.levels()) {}
  Camera camera;
  ScaleLevels levels;
};

// The way between two keyframes of a map along all keyframes between them, m.
double Travelled(const Map& map, KeyFrameId from, KeyFrameId to) {
  double length_m = 0;
  std::optional<Eigen::Vector3d> last;
  for (const KeyFrameId id : map.KeyFrameIds(map.MapOf(to))) {
    if (id < std::min(from, to) || id > std::max(from, to)) continue;
    const Eigen::Vector3d centre = map.FindKeyFrame(id)->CentreInWorld();
    if (last) length_m += (centre - *last).norm();
    last = centre;
  }
  return length_m;
}

void AddSupport(std::vector<PlaceMatch> more, Recognition& place) {
  for (PlaceMatch& match : more) {
    const bool known = match.current == place.match.current ||
                       std::any_of(place.supporting.begin(), place.supporting.end(),
                                   [&](const PlaceMatch& s) { return s.current == match.current; });
    if (!known) place.supporting.push_back(std::move(match));
  }
}

}  // namespace

std::optional<Recognition> LoopDetector::Detect(KeyFrameId id, const SharedMap& shared_map,
                                                const KeyFrameDatabase& database) {
  attempts_.clear();
  std::optional<PlaceWindow> current;
  {
    const SharedMap::Reader map = shared_map.Read();
    if (map->NumKeyFrames(map->MapOf(id)) < options_.min_keyframes) return std::nullopt;
    current = CopyWindow(*map, id, options_.verification.num_checked_neighbours);
  }
  if (!current) return std::nullopt;
  std::optional<Recognition> place =
      Look(PlaceKind::kMerge, *current, shared_map, database, merge_);
  const bool just_closed =
      last_loop_.valid() && id.value() - last_loop_.value() < options_.min_keyframes_between_loops;
  if (!place && !just_closed) place = Look(PlaceKind::kLoop, *current, shared_map, database, loop_);
  if (!place) return std::nullopt;
  // Whatever else was supposed is about the map before its correction.
  loop_.reset();
  merge_.reset();
  if (place->kind == PlaceKind::kLoop) last_loop_ = id;
  return place;
}

std::optional<Recognition> LoopDetector::Look(PlaceKind kind, const PlaceWindow& current,
                                              const SharedMap& shared_map,
                                              const KeyFrameDatabase& database,
                                              std::optional<Hypothesis>& hypothesis) {
  if (hypothesis && !FollowUp(current, shared_map, *hypothesis)) hypothesis.reset();
  if (!hypothesis) {
    const std::vector<KeyFrameId> candidates =
        Candidates(kind, current, *shared_map.Read(), database);
    hypothesis = Suppose(kind, candidates, current, shared_map);
  }
  // Only a keyframe that matches itself can be what the map is corrected by.
  const int needed = options_.verification.num_agreeing_keyframes;
  const bool complete = hypothesis && hypothesis->missed == 0 &&
                        static_cast<int>(hypothesis->place.supporting.size()) >= needed;
  return complete ? std::optional(hypothesis->place) : std::nullopt;
}

std::vector<KeyFrameId> LoopDetector::Candidates(PlaceKind kind, const PlaceWindow& current,
                                                 const Map& map,
                                                 const KeyFrameDatabase& database) const {
  const KeyFrameView& keyframe = current.centre();
  std::set<KeyFrameId> excluded = {keyframe.id};
  for (const auto& [neighbour, weight] : map.covisibility().All(keyframe.id))
    excluded.insert(neighbour);
  const auto accept = [&](KeyFrameId id) {
    const KeyFrame* other = map.FindKeyFrame(id);
    return other && (other->map_id == current.map_id) == (kind == PlaceKind::kLoop);
  };
  const auto neighbours = [&](KeyFrameId id) {
    return map.covisibility().Best(id, options_.verification.num_window_neighbours);
  };
  return database.PlaceCandidates(*keyframe.words, excluded, accept, neighbours,
                                  options_.num_candidates);
}

std::optional<LoopDetector::Hypothesis> LoopDetector::Suppose(
    PlaceKind kind, const std::vector<KeyFrameId>& candidates, const PlaceWindow& current,
    const SharedMap& shared_map) {
  const VerificationContext context(*shared_map.Read());
  const PlaceVerifier verifier(context.camera, context.levels, options_.verification, options_.pose,
                               noise_);
  std::optional<Hypothesis> best;
  for (const KeyFrameId candidate : candidates) {
    const std::optional<PlaceWindow> matched =
        CopyWindow(*shared_map.Read(), candidate, options_.verification.num_window_neighbours);
    if (!matched) continue;
    const uint64_t seed = seed_ + 1000003 * static_cast<uint64_t>(current.centre().id.value()) +
                          static_cast<uint64_t>(candidate.value());
    Recognition place{kind, verifier.Verify(current, *matched, seed), {}};
    PlaceMatch& match = place.match;
    if (match.accepted()) {
      place.supporting = verifier.AgreeingNeighbours(match, current, *matched);
      if (kind == PlaceKind::kLoop && !IsPlausible(match, *shared_map.Read()))
        match.verdict = PlaceVerdict::kTooMuchDrift;
    }
    Note(place);
    if (!match.accepted()) continue;
    if (!best || match.matches.size() > best->place.match.matches.size())
      best = Hypothesis{std::move(place)};
  }
  return best;
}

bool LoopDetector::FollowUp(const PlaceWindow& current, const SharedMap& shared_map,
                            Hypothesis& hypothesis) {
  Recognition& place = hypothesis.place;
  const KeyFrameId former = place.match.current;
  std::optional<PlaceWindow> matched;
  Rigid3d T_c_former;
  {
    const SharedMap::Reader map = shared_map.Read();
    if (!map->Knows(former) || map->MapOf(former) != current.map_id) return false;
    matched = CopyWindow(*map, place.match.matched, options_.verification.num_window_neighbours);
    T_c_former = current.centre().T_cw * map->PoseOf(former).Inverse();
  }
  if (!matched || (matched->map_id == current.map_id) != (place.kind == PlaceKind::kLoop))
    return false;
  const VerificationContext context(*shared_map.Read());
  const PlaceVerifier verifier(context.camera, context.levels, options_.verification, options_.pose,
                               noise_);
  PlaceMatch match =
      verifier.VerifyFrom(T_c_former * place.match.T_c_m, current.centre(), *matched);
  if (!match.accepted()) {
    Note({place.kind, std::move(match), {}});
    return ++hypothesis.missed <= options_.verification.max_missed_keyframes;
  }
  hypothesis.missed = 0;
  std::swap(place.match, match);
  AddSupport({std::move(match)}, place);
  AddSupport(verifier.AgreeingNeighbours(place.match, current, *matched), place);
  Note(place);
  return true;
}

void LoopDetector::Note(const Recognition& place) {
  attempts_.push_back({place.kind, place.match.matched, place.match.verdict,
                       static_cast<int>(place.match.matches.size()),
                       static_cast<int>(place.supporting.size())});
}

// RGB-D odometry drifts by a few percent: a loop that says otherwise joins two places that only
// look alike.
bool LoopDetector::IsPlausible(const PlaceMatch& match, const Map& map) const {
  const KeyFrame* current = map.FindKeyFrame(match.current);
  const KeyFrame* matched = map.FindKeyFrame(match.matched);
  if (!current || !matched) return false;
  const PlaceVerificationOptions& options = options_.verification;
  const Rigid3d T_c_m = current->T_cw * matched->T_cw.Inverse();
  const double drift_m =
      (match.T_c_m.Inverse().translation() - T_c_m.Inverse().translation()).norm();
  const double travelled_m = Travelled(map, match.matched, match.current);
  return drift_m <= std::max(options.min_allowed_drift_m, options.max_drift_share * travelled_m);
}

}  // namespace msf
