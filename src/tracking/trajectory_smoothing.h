// Noise of the single poses, taken out of the whole path afterwards.
#pragma once

#include <vector>

#include "tracking/trajectory_recorder.h"

namespace msf {

// The frames, in the order of time, with their poses on a smooth path: each pose is that of a
// motion of second degree fitted to the poses around it, which count less the farther away in time
// they are (a Gaussian of standard deviation `width_s`; local regression, Cleveland 1979). Motions
// slower than about 0.2 / width_s Hz stay as they are. Only frames of the same map without a gap
// between them are fitted together; a frame with too few of them keeps its pose, and so do all with
// a width of 0.
std::vector<ResolvedFrame> SmoothTrajectory(const std::vector<ResolvedFrame>& frames,
                                            double width_s);

}  // namespace msf
