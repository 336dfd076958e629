#include "tracking/hindsight.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "tracking/first_frame.h"

namespace msf {
namespace {

// Poses further apart say little about the velocity.
constexpr double kLongestGap_s = 0.2;

}  // namespace

std::vector<TrackedFrame> FrameDelay::TakeDue() {
  std::vector<TrackedFrame> due;
  while (!frames_.empty() && frames_.back().time_s - frames_.front().time_s >= delay_s_) {
    due.push_back(std::move(frames_.front()));
    frames_.pop_front();
  }
  return due;
}

std::vector<TrackedFrame> FrameDelay::TakeAll() {
  std::vector<TrackedFrame> all(std::make_move_iterator(frames_.begin()),
                                std::make_move_iterator(frames_.end()));
  frames_.clear();
  return all;
}

void Hindsight::Match(const TrackedFrame& frame) {
  if (first_) {
    const TrackedFrame first = *std::exchange(first_, std::nullopt);
    // One that begins anew itself may be in another map.
    const bool follows = !frame.shutter_left_in && frame.time_s - first.time_s < kLongestGap_s;
    if (follows) {
      MatchFirst(first, frame);
    } else {
      MatchOne(first);
    }
  }
  if (frame.shutter_left_in) {
    first_ = frame;
  } else {
    MatchOne(frame);
  }
}

std::optional<Rigid3d> Hindsight::Approach(const Map& map, const TrackedFrame& tracked) {
  if (!map.Knows(tracked.reference)) return std::nullopt;
  Frame frame;
  frame.T_cw = tracked.T_c_reference * map.PoseOf(tracked.reference);
  for (const MapPointId point : tracked.points) {
    const MapPointId now = map.Resolve(point);
    if (map.FindPoint(now)) frame.points.push_back(now);
  }
  local_map_.Update(map, frame, context_.options.max_local_keyframes,
                    context_.options.max_neighbours);
  return frame.T_cw;
}

void Hindsight::MatchOne(const TrackedFrame& frame) {
  const std::optional<Rigid3d> T_cw = Approach(*map_.Read(), frame);
  if (!T_cw) return;
  const LocalMatches local = MatchLocalPoints(context_, local_map_.points(), *frame.features, *T_cw,
                                              {}, context_.options.local_radius_factor_refined);
  Remember(frame.id, *frame.features, local.matches);
}

void Hindsight::MatchFirst(const TrackedFrame& first, const TrackedFrame& second) {
  std::optional<Rigid3d> T_cw_first, T_cw_second;
  uint64_t epoch = 0;
  {
    const SharedMap::Reader map = map_.Read();
    epoch = map->epoch();
    T_cw_second = Approach(*map, second);
    T_cw_first = Approach(*map, first);
  }
  if (!T_cw_first || !T_cw_second) return;
  const std::optional<FirstFrame> settled =
      SettleFirstFrame(context_, local_map_.points(), *first.features, *T_cw_first, *T_cw_second,
                       second.time_s - first.time_s);
  if (!settled) {
    MatchOne(first);
    return;
  }
  Remember(first.id, *settled->features, settled->matches);
  const SharedMap::Writer map = map_.Write();
  const KeyFrame* keyframe = map->FindKeyFrame(first.reference);
  // A correction of the whole map since then would have moved what was found.
  if (map->epoch() != epoch) return;
  if (!keyframe || keyframe->features != first.features) return;
  map->SetFeatures(keyframe->id, settled->features);
  map->SetPose(keyframe->id, settled->T_cw);
}

void Hindsight::Remember(FrameId id, const FrameFeatures& features,
                         const std::vector<PointMatch>& matches) {
  Entry entry{id, {}};
  entry.sightings.reserve(matches.size());
  for (const PointMatch& match : matches) {
    const int i = match.feature;
    entry.sightings.push_back({.point = static_cast<int32_t>(match.point.value()),
                               .u_px = features.uv_px[i].x(),
                               .v_px = features.uv_px[i].y(),
                               .depth_m = features.depth_m[i],
                               .weight = static_cast<float>(match.weight),
                               .level = features.level[i]});
  }
  entries_.push_back(std::move(entry));
  if (entries_.size() <= static_cast<size_t>(context_.options.hindsight.max_frames)) return;
  entries_.pop_front();
  ++num_left_out_;
}

std::vector<PoseObservation> Hindsight::Observe(const Entry& entry, const Map& map,
                                                MapId id) const {
  std::vector<PoseObservation> observations;
  observations.reserve(entry.sightings.size());
  for (const Sighting& sighting : entry.sightings) {
    const MapPoint* point = map.FindPoint(map.Resolve(MapPointId(sighting.point)));
    if (!point || point->map_id != id) continue;
    const double weight = std::min(sighting.weight, point->static_weight);
    PoseObservation observation{ObserveFeature({.uv_px = {sighting.u_px, sighting.v_px},
                                                .depth_m = sighting.depth_m,
                                                .level = sighting.level},
                                               context_.camera, context_.levels, context_.noise,
                                               weight)};
    observation.p_w = point->p_w;
    observations.push_back(observation);
  }
  return observations;
}

void Hindsight::Revise(const Map& map, std::vector<ResolvedFrame>& frames) const {
  auto frame = frames.begin();
  for (const Entry& entry : entries_) {
    while (frame != frames.end() && frame->frame_id < entry.id) ++frame;
    if (frame == frames.end()) return;
    if (frame->frame_id != entry.id || !frame->T_wc) continue;
    const PoseEstimate estimate =
        OptimizePose(context_.camera, frame->T_wc->Inverse(), Observe(entry, map, frame->map_id),
                     context_.options.pose);
    if (estimate.num_inliers >= context_.options.min_local_inliers)
      frame->T_wc = estimate.T_cw.Inverse();
  }
}

}  // namespace msf
