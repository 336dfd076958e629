// What a frame tells about whether the points of the map stand still.
#pragma once

#include <span>
#include <vector>

#include "tracking/pose_tracking.h"

namespace msf {

// One observation of a map point: how probable it is, by this frame, that it belongs to the static
// world.
struct StaticEvidence {
  MapPointId point;
  float static_probability = 1;
};

// `matches`: map points found among the frame's own features. `local_points` that are not among
// them are looked for where `T_cw` puts them in `removed`: the features that the frame did without
// because they seem to move, with their static probabilities. What says nothing new (a point that
// was never suspected, found on a feature that is not) is left out.
std::vector<StaticEvidence> GatherStaticEvidence(const TrackingContext& context,
                                                 std::span<const PointSnapshot> local_points,
                                                 const FrameFeatures& features,
                                                 std::span<const PointMatch> matches,
                                                 const FrameFeatures& removed, const Rigid3d& T_cw);

}  // namespace msf
