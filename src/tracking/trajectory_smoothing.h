// Noise of the single poses, taken out of the whole path afterwards.
#pragma once

#include <vector>

#include "tracking/tracking_options.h"
#include "tracking/trajectory_recorder.h"

namespace msf {

// The frames, in the order of time, with their poses on a smooth path: positions and rotations are
// those of motions of fourth degree fitted to the frames around, which count less the farther away
// in time they are (Gaussians of the standard deviations in `options`; local regression, Cleveland
// 1979). Motions slower than about 0.15 / width Hz stay as they are. Only frames of the same map
// without a gap between them are fitted together; a frame with too few of them keeps what it has.
std::vector<ResolvedFrame> SmoothTrajectory(const std::vector<ResolvedFrame>& frames,
                                            const SmoothingOptions& options);

}  // namespace msf
