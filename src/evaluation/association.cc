#include "evaluation/association.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace msf {
namespace {

// The pose nearest in time, the earlier one of two that are equally near.
const StampedPose& Nearest(const Trajectory& trajectory, double time_s) {
  const auto not_before =
      std::lower_bound(trajectory.begin(), trajectory.end(), time_s,
                       [](const StampedPose& pose, double t) { return pose.time_s < t; });
  if (not_before == trajectory.begin()) return *not_before;
  const auto before = std::prev(not_before);
  if (not_before == trajectory.end()) return *before;
  return time_s - before->time_s <= not_before->time_s - time_s ? *before : *not_before;
}

}  // namespace

std::vector<PosePair> AssociateTrajectories(const Trajectory& truth, const Trajectory& estimate,
                                            double max_gap_s) {
  std::vector<PosePair> pairs;
  if (truth.empty() || estimate.empty()) return pairs;
  const bool estimate_leads = estimate.size() <= truth.size();
  for (const StampedPose& pose : estimate_leads ? estimate : truth) {
    const StampedPose& nearest = Nearest(estimate_leads ? truth : estimate, pose.time_s);
    if (std::abs(nearest.time_s - pose.time_s) > max_gap_s) continue;
    const StampedPose& estimated = estimate_leads ? pose : nearest;
    pairs.push_back({estimated.time_s, estimated.T_wc, estimate_leads ? nearest.T_wc : pose.T_wc});
  }
  return pairs;
}

}  // namespace msf
