#include "tracking/trajectory_recorder.h"

#include <cmath>

namespace msf {
namespace {

constexpr double kMaxGap_s = 0.5;  // a camera does not keep its velocity for longer

}  // namespace

bool AreNeighbours(const ResolvedFrame& a, const ResolvedFrame& b) {
  const double gap_s = std::abs(a.time_s - b.time_s);
  return a.T_wc && b.T_wc && a.map_id == b.map_id && gap_s > 0 && gap_s <= kMaxGap_s;
}

void TrajectoryRecorder::Record(const TrackingResult& result) {
  entries_.push_back({result.frame_id, result.time_s, result.state,
                      result.T_cw ? result.reference : KeyFrameId(), result.T_c_reference});
}

std::vector<ResolvedFrame> TrajectoryRecorder::Resolve(const Map& map) const {
  std::vector<ResolvedFrame> frames;
  frames.reserve(entries_.size());
  for (const Entry& entry : entries_) {
    ResolvedFrame frame{entry.frame_id, entry.time_s, entry.state, std::nullopt, MapId()};
    if (entry.reference.valid() && map.Knows(entry.reference)) {
      frame.T_wc = (entry.T_c_reference * map.PoseOf(entry.reference)).Inverse();
      frame.map_id = map.MapOf(entry.reference);
    }
    frames.push_back(frame);
  }
  return frames;
}

}  // namespace msf
