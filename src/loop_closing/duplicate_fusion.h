// Makes one of the points that two passes through a place have made twice.
#pragma once

#include <span>

#include "map/map.h"

namespace msf {

// Projects `points`, established ones, into a keyframe. A feature found there shows the
// established point from now on: its own point, if any, is replaced, and so loses its place.
// Returns how many points were replaced or observed anew.
int FuseIntoKeyFrame(std::span<const MapPointId> points, KeyFrameId keyframe, double radius_px,
                     Map& map);

// Makes the given features of a keyframe show the given established points.
int FuseMatches(std::span<const std::pair<int, MapPointId>> matches, KeyFrameId keyframe, Map& map);

}  // namespace msf
