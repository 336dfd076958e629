// Finds points that two keyframes hold twice and makes one of them.
#pragma once

#include <span>
#include <vector>

#include "map/map.h"
#include "optimization/feature_observation.h"

namespace msf {

// A feature of a keyframe that looks like a point of the map and lies where it projects.
struct PointSighting {
  MapPointId point;
  int feature = 0;
};

// Projects `points` into a keyframe and finds the features that look like them. Points the keyframe
// sees already are left out. This is what takes long, and it changes nothing.
std::vector<PointSighting> FindPointsAgain(const NoiseOptions& noise,
                                           std::span<const MapPointId> points, KeyFrameId keyframe,
                                           double radius_px, const Map& map);

// Makes the feature's point and the one that was found there one (the better observed stays); a
// feature without a point is connected. Points that have gone since are left out. Returns how many
// were fused or connected.
int FusePoints(std::span<const PointSighting> sightings, KeyFrameId keyframe, Map& map);

}  // namespace msf
