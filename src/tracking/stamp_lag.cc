#include "tracking/stamp_lag.h"

namespace msf {
namespace {

// Where a frame is after `seconds`, if its velocity is that between it and its neighbour.
Rigid3d MoveOn(const ResolvedFrame& frame, const ResolvedFrame& neighbour, double seconds) {
  const Vector6d to_neighbour = (frame.T_wc->Inverse() * *neighbour.T_wc).Log();
  return *frame.T_wc * Rigid3d::Exp(to_neighbour * (seconds / (neighbour.time_s - frame.time_s)));
}

}  // namespace

std::vector<ResolvedFrame> UndoStampLag(const std::vector<ResolvedFrame>& frames,
                                        double stamp_lag_s) {
  std::vector<ResolvedFrame> moved = frames;
  if (stamp_lag_s == 0) return moved;
  for (size_t i = 0; i < frames.size(); ++i) {
    const bool has_next = i + 1 < frames.size() && AreNeighbours(frames[i], frames[i + 1]);
    const bool has_last = i > 0 && AreNeighbours(frames[i], frames[i - 1]);
    // The lag ends between this frame and the next, or, if it is negative, the last.
    const bool use_next = has_next && (stamp_lag_s > 0 || !has_last);
    if (!has_next && !has_last) continue;
    moved[i].T_wc = MoveOn(frames[i], frames[use_next ? i + 1 : i - 1], stamp_lag_s);
  }
  return moved;
}

}  // namespace msf
