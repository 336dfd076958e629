// Finds points that two keyframes hold twice and makes one of them.
#pragma once

#include <span>

#include "map/map.h"
#include "optimization/feature_observation.h"

namespace msf {

// Projects `points` into a keyframe. Where one meets a feature that looks like it, the feature's
// point and the projected one become one (the better observed stays); a feature without a point is
// connected. Points the keyframe sees already are left out. Returns how many were fused or
// connected.
int FusePoints(const NoiseOptions& noise, std::span<const MapPointId> points, KeyFrameId keyframe,
               double radius_px, Map& map);

}  // namespace msf
