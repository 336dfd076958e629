// Turns a tracked frame into a keyframe of the map.
#pragma once

#include "map/map.h"
#include "tracking/keyframe_policy.h"
#include "tracking/pose_tracking.h"

namespace msf {

// Adds the frame with the map points it shows, and new points for its static close depths (at least
// the 100 nearest depths); the frame's own list of points grows along.
KeyFrameId InsertKeyFrame(const TrackingContext& context, Frame& frame, Map& map);

// How well the frame is tied to the map compared with its reference keyframe.
KeyFrameEvidence GatherEvidence(const TrackingContext& context, const Map& map, const Frame& frame);

}  // namespace msf
