#include "tracking/keyframe_policy.h"

namespace msf {

bool WantsKeyFrame(const KeyFrameEvidence& evidence, const MappingLoad& load,
                   const KeyFramePolicyOptions& options) {
  const bool few_close = evidence.tracked_close < options.min_tracked_close &&
                         evidence.untracked_close > options.max_untracked_close;
  const bool due = evidence.since_last_s >= options.max_interval_s;
  const bool urgent =
      evidence.inliers < options.urgent_ratio * evidence.reference_points || few_close;
  const bool worth_it =
      evidence.inliers < options.reference_ratio * evidence.reference_points || few_close;
  if (!(due || load.idle || urgent)) return false;
  if (!worth_it || evidence.inliers <= options.min_inliers) return false;
  return load.idle || load.queued < options.max_queued;
}

}  // namespace msf
