// A place that has been recognised.
#pragma once

#include <vector>

#include "loop_closing/place_verification.h"

namespace msf {

enum class PlaceKind { kLoop, kMerge };

// A place that enough keyframes agree on.
struct Recognition {
  PlaceKind kind = PlaceKind::kLoop;
  PlaceMatch match;                    // of the keyframe just looked at
  std::vector<PlaceMatch> supporting;  // other keyframes that agree, with the same matched one
};

// What became of one candidate.
struct PlaceAttempt {
  PlaceKind kind = PlaceKind::kLoop;
  KeyFrameId matched;
  PlaceVerdict verdict = PlaceVerdict::kAccepted;
  int num_matches = 0;
  int num_supporting = 0;  // other keyframes that agree so far
};

}  // namespace msf
