#include "tracking/tracker.h"

#include <algorithm>

#include "feature/rolling_shutter.h"
#include "tracking/keyframe_creation.h"
#include "tracking/landmarks.h"
#include "tracking/static_evidence.h"

namespace msf {
namespace {

// For so long after relocalisation tracking searches wider and asks for more inliers.
constexpr double kFreshlyRelocalized_s = 1.0;

constexpr int kMaxLocateAttempts = 3;

// Twist per second of a camera whose coordinates `T_now_then` takes from then to now.
Vector6d VelocityOf(const Rigid3d& T_now_then, double interval_s) {
  return T_now_then.Log() / interval_s;
}

}  // namespace

const char* ToString(TrackingState state) {
  switch (state) {
    case TrackingState::kInitialising:
      return "initialising";
    case TrackingState::kTracking:
      return "tracking";
    case TrackingState::kRecentlyLost:
      return "recently_lost";
    case TrackingState::kLost:
      return "lost";
  }
  return "unknown";
}

Tracker::Tracker(const Options& options, std::shared_ptr<const Camera> camera,
                 const ScaleLevels& levels, SharedMap& map,
                 std::shared_ptr<const Vocabulary> vocabulary, const KeyFrameDatabase& database)
    : options_(options),
      camera_(std::move(camera)),
      levels_(levels),
      context_{*camera_, levels_, options_.tracking, options_.noise},
      map_(map),
      vocabulary_(std::move(vocabulary)),
      database_(database) {}

TrackingResult Tracker::Track(RgbdFramePtr image, std::shared_ptr<const FrameFeatures> features,
                              std::shared_ptr<const FrameFeatures> removed, const MappingLoad& load,
                              const std::optional<Rigid3d>& T_now_last) {
  TrackingResult result;
  T_now_last_ = last_frame_tracked_ ? T_now_last : std::nullopt;
  result.frame_id = image->id;
  result.time_s = image->time_s;
  result.num_features = features->size();
  extracted_ = std::move(features);
  extracted_removed_ = std::move(removed);
  taken_back_.clear();
  frame_ = Frame();
  frame_.image = std::move(image);
  BeginAnew();

  const bool has_map = state_ == TrackingState::kTracking || state_ == TrackingState::kRecentlyLost;
  bool tracked;
  if (has_map) {
    tracked = Locate(result);
    result.epoch = epoch_;
    if (tracked) InsertKeyFrameIfWanted(load, result);
  } else {
    tracked = StartMap(result);
  }
  UpdateState(tracked, result);
  RememberFrame(tracked, result);
  return result;
}

Rigid3d Tracker::PredictMotion(double duration_s) const {
  const std::optional<Vector6d> velocity = PredictVelocity();
  return velocity ? Rigid3d::Exp(*velocity * duration_s) : Rigid3d();
}

bool Tracker::StartMap(TrackingResult& result) {
  const int with_depth = static_cast<int>(std::count_if(frame_.features->depth_m.begin(),
                                                        frame_.features->depth_m.end(),
                                                        [](float depth_m) { return depth_m > 0; }));
  if (frame_.features->size() < options_.tracking.min_initial_points) return false;
  if (with_depth < options_.tracking.min_initial_depths) return false;
  SharedMap::Writer map = map_.Write();
  map->StartNewMap();
  BecomeKeyFrame(*map, result);
  result.epoch = map->epoch();
  result.started_map = true;
  local_map_.Clear();
  result.num_inliers = frame_.NumPoints();
  return true;
}

// Another thread may correct the whole map in the middle of a frame, and places from before and
// after do not go together: then the frame is located once more.
bool Tracker::Locate(TrackingResult& result) {
  for (int attempt = 1;; ++attempt) {
    epoch_ = map_.Read()->epoch();
    bool located = LocateByVelocity(result);
    if (!located && T_now_last_) {
      // It does not go on as it did.
      BeginAnew();
      velocity_ = T_now_last_;
      velocity_interval_s_ = frame_.image->time_s - last_.image->time_s;
      located = LocateByVelocity(result);
    }
    if (!located && TakeBackDoubtful()) located = LocateByVelocity(result);
    if (!taken_back_.empty()) result.readmitted = located ? taken_back_ : std::vector<int>();
    if (attempt == kMaxLocateAttempts || map_.Read()->epoch() == epoch_) return located;
    BeginAnew();
  }
}

// Rather than losing track: what only a mask or a single test speaks against may be static, too.
bool Tracker::TakeBackDoubtful() {
  if (!taken_back_.empty()) return false;
  auto features = std::make_shared<FrameFeatures>(*extracted_);
  for (int i = 0; i < extracted_removed_->size(); ++i) {
    const float probability = extracted_removed_->static_weight[i];
    if (probability < options_.tracking.readmit_probability) continue;
    features->Append(*extracted_removed_, i, probability);
    taken_back_.push_back(i);
  }
  if (taken_back_.empty()) return false;
  features->BuildGrid(*camera_);
  extracted_ = std::move(features);
  extracted_removed_ = std::make_shared<const FrameFeatures>();
  frame_.words.reset();  // of fewer features
  BeginAnew();
  return true;
}

bool Tracker::LocateByVelocity(TrackingResult& result) {
  UndoRollingShutterAt(PredictVelocity());
  if (!FindPose(result)) return false;
  // The velocity is known better now than it could be predicted.
  UndoRollingShutterAt(MeasureVelocity());
  return RefineWithLocalMap(result);
}

void Tracker::BeginAnew() {
  frame_.features = extracted_;
  frame_.removed = extracted_removed_;
  frame_.shutter_left_in = IsRolling();
  frame_.relocalized = false;
  TakeMatches({});
  matches_.clear();
}

bool Tracker::IsRolling() const {
  return camera_->rolling_shutter_s > 0 && options_.tracking.undo_rolling_shutter;
}

void Tracker::UndoRollingShutterAt(const std::optional<Vector6d>& velocity) {
  if (!IsRolling() || !velocity) return;
  const auto undo = [&](const FrameFeatures& extracted) {
    return std::make_shared<const FrameFeatures>(
        UndoRollingShutter(extracted, *camera_, *velocity));
  };
  frame_.features = undo(*extracted_);
  frame_.removed = undo(*extracted_removed_);
  frame_.shutter_left_in = false;
}

std::optional<Vector6d> Tracker::PredictVelocity() const {
  if (!velocity_) return std::nullopt;
  return VelocityOf(*velocity_, velocity_interval_s_);
}

std::optional<Vector6d> Tracker::MeasureVelocity() const {
  // A pose found anew may be in another map, or far from where the last one was taken to be.
  if (!last_frame_tracked_ || frame_.relocalized) return std::nullopt;
  const double interval_s = frame_.image->time_s - last_.image->time_s;
  const Vector6d mean = VelocityOf(frame_.T_cw * last_.T_cw.Inverse(), interval_s);
  const std::optional<Vector6d> mean_before = PredictVelocity();
  if (!mean_before) return mean;
  // The mean since the last frame was true half an interval ago, the one before it another half
  // earlier.
  const double going_on = interval_s / (interval_s + velocity_interval_s_);
  return mean + options_.tracking.velocity_trend * going_on * (mean - *mean_before);
}

bool Tracker::FindPose(TrackingResult& result) {
  const StageTimer timer(result.timings_ms, "pose");
  if (state_ == TrackingState::kTracking) {
    RefreshLastFrame();
    // Without a velocity the camera may be anywhere near: words need no prediction.
    const bool found = velocity_ ? FollowMotion() || FollowReferenceKeyFrame()
                                 : FollowReferenceKeyFrame() || FollowMotion();
    if (found) return true;
  }
  return RelocalizeFrame();
}

void Tracker::RefreshLastFrame() {
  last_.T_cw = last_.T_c_reference * map_.Read()->PoseOf(last_.reference);
}

bool Tracker::FollowMotion() {
  frame_.T_cw = PredictMotion(frame_.image->time_s - last_.image->time_s) * last_.T_cw;
  matches_ = MatchLastFrame(context_, *map_.Read(), last_, *frame_.features, frame_.T_cw);
  if (static_cast<int>(matches_.size()) < options_.tracking.min_motion_matches) return false;
  return OptimizeFramePose(context_, *frame_.features, options_.tracking.min_pose_inliers, matches_,
                           frame_.T_cw);
}

bool Tracker::FollowReferenceKeyFrame() {
  const BagOfWords& words = FrameWords();
  {
    const SharedMap::Reader map = map_.Read();
    const KeyFrame* reference = map->FindKeyFrame(last_.reference);
    if (!reference) return false;
    const BagOfWords reference_words =
        reference->words ? *reference->words
                         : vocabulary_->Transform(reference->features->descriptors);
    matches_ = MatchKeyFrame(*map, *reference, reference_words, *frame_.features, words,
                             options_.tracking.reference_match_ratio);
  }
  if (static_cast<int>(matches_.size()) < options_.tracking.min_reference_matches) return false;
  frame_.T_cw = last_.T_cw;
  return OptimizeFramePose(context_, *frame_.features, options_.tracking.min_pose_inliers, matches_,
                           frame_.T_cw);
}

bool Tracker::RelocalizeFrame() {
  if (frame_.features->size() < options_.relocalization.min_matches) return false;
  const BagOfWords& words = FrameWords();
  const SharedMap::Reader map = map_.Read();
  const auto covisible = [&](KeyFrameId id) {
    return map->covisibility().Best(id, options_.tracking.max_neighbours);
  };
  const std::vector<KeyFrameId> candidates = database_.RelocalizationCandidates(words, covisible);
  const uint64_t seed = options_.seed + static_cast<uint64_t>(frame_.image->id.value());
  std::optional<Relocalization> found = Relocalize(context_, options_.relocalization, *map,
                                                   candidates, *frame_.features, words, seed);
  if (!found) return false;
  frame_.T_cw = found->T_cw;
  frame_.reference = found->keyframe;
  matches_ = std::move(found->matches);
  frame_.relocalized = true;
  return true;
}

bool Tracker::RefineWithLocalMap(TrackingResult& result) {
  const StageTimer timer(result.timings_ms, "local_map");
  const TrackingOptions& options = options_.tracking;
  for (const PointMatch& match : matches_) frame_.points[match.feature] = match.point;
  local_map_.Update(*map_.Read(), frame_, options.max_local_keyframes, options.max_neighbours);
  const bool fresh =
      frame_.relocalized || frame_.image->time_s - relocalized_time_s_ < kFreshlyRelocalized_s;
  const int min_inliers = fresh ? options.min_local_inliers_relocalized : options.min_local_inliers;
  double radius_factor =
      fresh ? options.local_radius_factor_relocalized : options.local_radius_factor;
  std::vector<MapPointId> expected;
  bool tracked = true;
  // The first search starts from a prediction and finds what pulls the pose into place; the second
  // one starts there, so that points which a fast turn or a poor first pose had put too far away
  // are found as well.
  for (int round = 0; round < options.local_search_rounds && tracked; ++round) {
    LocalMatches local = MatchLocalPoints(context_, local_map_.points(), *frame_.features,
                                          frame_.T_cw, matches_, radius_factor);
    expected = std::move(local.expected);
    matches_.insert(matches_.end(), local.matches.begin(), local.matches.end());
    tracked = OptimizeFramePose(context_, *frame_.features, min_inliers, matches_, frame_.T_cw);
    radius_factor = options.local_radius_factor_refined;
  }
  if (tracked) {
    suspects_ = FindSuspects(context_, local_map_.points(), *frame_.removed, frame_.T_cw, matches_);
    tracked = ReadmitKnown(min_inliers, result);
  }
  result.num_inliers = static_cast<int>(matches_.size());
  TakeMatches(matches_);
  if (!local_map_.best_keyframe().valid()) return false;
  frame_.reference = local_map_.best_keyframe();
  frame_.T_c_reference = frame_.T_cw * local_map_.T_cw_best_keyframe().Inverse();

  TellMap(expected, tracked);
  return tracked;
}

bool Tracker::ReadmitKnown(int min_inliers, TrackingResult& result) {
  result.readmitted.clear();
  if (suspects_.empty()) return true;
  const FrameFeatures& removed = *frame_.removed;
  auto features = std::make_shared<FrameFeatures>(*frame_.features);
  std::vector<int> added;  // the removed feature behind each one that is added
  for (const auto& [feature, point] : suspects_) {
    const float probability = removed.static_weight[feature];
    if (probability < options_.tracking.readmit_probability ||
        point->static_weight < options_.tracking.readmit_point_probability)
      continue;
    matches_.push_back({features->size(), point->id, point->p_w, point->static_weight});
    features->Append(removed, feature, probability);
    added.push_back(feature);
  }
  if (added.empty()) return true;
  const bool tracked = OptimizeFramePose(context_, *features, min_inliers, matches_, frame_.T_cw);
  const int num_own = features->size() - static_cast<int>(added.size());
  for (const PointMatch& match : matches_) {
    if (match.feature < num_own) continue;
    features->static_weight[match.feature] = static_cast<float>(match.weight);
    result.readmitted.push_back(added[match.feature - num_own]);
  }
  features->BuildGrid(*camera_);
  frame_.features = std::move(features);
  frame_.words.reset();  // of fewer features
  return tracked;
}

void Tracker::TellMap(const std::vector<MapPointId>& expected, bool tracked) {
  std::vector<StaticEvidence> evidence;
  if (tracked) {
    evidence = GatherStaticEvidence(*frame_.features, matches_, *frame_.removed, suspects_);
  }
  SharedMap::Writer map = map_.Write();
  for (const MapPointId id : expected) {
    if (map->FindPoint(id)) map->CountVisible(id);
  }
  for (const PointMatch& match : matches_) {
    if (map->FindPoint(match.point)) map->CountFound(match.point);
  }
  for (const auto& [id, probability] : evidence) {
    if (map->FindPoint(id)) map->ObserveStaticProbability(id, probability);
  }
}

void Tracker::TakeMatches(const std::vector<PointMatch>& matches) {
  frame_.points.assign(frame_.features->size(), MapPointId());
  for (const PointMatch& match : matches) frame_.points[match.feature] = match.point;
}

void Tracker::InsertKeyFrameIfWanted(const MappingLoad& load, TrackingResult& result) {
  const StageTimer timer(result.timings_ms, "keyframe");
  KeyFrameEvidence evidence = GatherEvidence(context_, *map_.Read(), frame_);
  evidence.since_last_s = result.time_s - last_keyframe_time_s_;
  if (!WantsKeyFrame(evidence, load, options_.tracking.keyframe)) return;
  SharedMap::Writer map = map_.Write();
  // The map may have been corrected since it was matched: the frame joins it where its reference
  // keyframe is now.
  frame_.T_cw = frame_.T_c_reference * map->PoseOf(frame_.reference);
  result.epoch = map->epoch();
  // Relocalisation may have found the camera in an older map.
  map->SetActiveMap(map->MapOf(frame_.reference));
  BecomeKeyFrame(*map, result);
}

void Tracker::BecomeKeyFrame(Map& map, TrackingResult& result) {
  frame_.reference = InsertKeyFrame(context_, frame_, map);
  frame_.T_c_reference = Rigid3d();
  last_keyframe_time_s_ = result.time_s;
  result.new_keyframe = frame_.reference;
}

void Tracker::UpdateState(bool tracked, TrackingResult& result) {
  if (tracked) {
    state_ = TrackingState::kTracking;
    last_tracked_time_s_ = result.time_s;
    if (frame_.relocalized) relocalized_time_s_ = result.time_s;
  } else if (state_ == TrackingState::kTracking) {
    state_ = TrackingState::kRecentlyLost;
  } else if (state_ == TrackingState::kRecentlyLost &&
             result.time_s - last_tracked_time_s_ > options_.tracking.recently_lost_s) {
    state_ = TrackingState::kLost;
    SharedMap::Writer map = map_.Write();
    const MapId active = map->active_map();
    if (map->NumKeyFrames(active) < options_.tracking.min_keyframes_to_keep_map)
      map->DropMap(active);
  }
  result.state = state_;
}

void Tracker::RememberFrame(bool tracked, TrackingResult& result) {
  T_now_last_.reset();
  velocity_.reset();
  // Two poses from before and after a correction of the map say nothing about the camera's motion.
  const bool same_epoch = map_.Read()->epoch() == epoch_;
  const bool follows =
      tracked && last_frame_tracked_ && !result.started_map && !frame_.relocalized && same_epoch;
  last_frame_tracked_ = tracked;
  if (!tracked) return;
  if (follows) {
    velocity_ = frame_.T_cw * last_.T_cw.Inverse();
    velocity_interval_s_ = frame_.image->time_s - last_.image->time_s;
  }
  result.landmarks = FindLandmarks(context_, *map_.Read(), frame_, *extracted_, matches_);
  result.T_cw = frame_.T_cw;
  result.map_id = map_.Read()->MapOf(frame_.reference);
  result.reference = frame_.reference;
  result.T_c_reference = frame_.T_c_reference;
  result.features = frame_.features;
  result.shutter_left_in = frame_.shutter_left_in;
  result.points = frame_.points;
  last_ = std::move(frame_);
}

const BagOfWords& Tracker::FrameWords() {
  if (!frame_.words) {
    frame_.words =
        std::make_shared<const BagOfWords>(vocabulary_->Transform(frame_.features->descriptors));
  }
  return *frame_.words;
}

}  // namespace msf
