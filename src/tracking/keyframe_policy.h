// When a frame becomes a keyframe.
#pragma once

#include "tracking/tracking_options.h"

namespace msf {

// How busy the mapper is.
struct MappingLoad {
  bool idle = true;
  int queued = 0;  // keyframes waiting
};

// What the decision is based on.
struct KeyFrameEvidence {
  double since_last_s = 0;   // time since the last keyframe
  int inliers = 0;           // tracked map points
  int reference_points = 0;  // well-observed points of the reference keyframe
  int tracked_close = 0;     // close features with a tracked point
  int untracked_close = 0;   // close features that the map does not have
  double hidden_share = 0;   // of all features, those that are left out because they seem to move
};

bool WantsKeyFrame(const KeyFrameEvidence& evidence, const MappingLoad& load,
                   const KeyFramePolicyOptions& options);

}  // namespace msf
