#include "tracking/keyframe_policy.h"

#include <cmath>

namespace msf {

namespace {

// Movers hide for a moment what the reference shows, and soon hide what shows beside them now: the
// more they cover, the sooner the map must take in what is there to be seen.
double WantedShare(double hidden_share, const KeyFramePolicyOptions& options) {
  const double may_be_missing = 1 - options.reference_ratio;
  return 1 - may_be_missing * std::pow(1 - hidden_share, options.hidden_exponent);
}

}  // namespace

bool WantsKeyFrame(const KeyFrameEvidence& evidence, const MappingLoad& load,
                   const KeyFramePolicyOptions& options) {
  const bool few_close = evidence.tracked_close < options.min_tracked_close &&
                         evidence.untracked_close > options.max_untracked_close;
  const bool due = evidence.since_last_s >= options.max_interval_s;
  const bool urgent =
      evidence.inliers < options.urgent_ratio * evidence.reference_points || few_close;
  const bool worth_it =
      evidence.inliers < WantedShare(evidence.hidden_share, options) * evidence.reference_points ||
      few_close;
  if (!(due || load.idle || urgent)) return false;
  if (!worth_it || evidence.inliers <= options.min_inliers) return false;
  return load.idle || load.queued < options.max_queued;
}

}  // namespace msf
