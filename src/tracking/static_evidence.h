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

// `matches`: map points found among the frame's own features. `suspects`: those found among
// `removed`, the features that the frame did without, with their static probabilities; the ones
// that are in `matches` by now have been readmitted and are doubted no more. What says nothing new
// (a point that was never suspected, found on a feature that is not) is left out.
std::vector<StaticEvidence> GatherStaticEvidence(const FrameFeatures& features,
                                                 std::span<const PointMatch> matches,
                                                 const FrameFeatures& removed,
                                                 std::span<const Suspect> suspects);

}  // namespace msf
