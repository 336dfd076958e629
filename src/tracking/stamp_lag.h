// A sensor may stamp an image later than it exposes it: then the pose found in the image is older
// than its time stamp.
#pragma once

#include <vector>

#include "tracking/trajectory_recorder.h"

namespace msf {

// The frames, in the order of time, with the poses that they had `stamp_lag_s` after those given:
// on the way to the next frame of the same map, or on from the one before where there is no such
// frame within half a second. A frame without neighbours keeps its pose.
std::vector<ResolvedFrame> UndoStampLag(const std::vector<ResolvedFrame>& frames,
                                        double stamp_lag_s);

}  // namespace msf
