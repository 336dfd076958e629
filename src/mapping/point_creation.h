// New map points from features that two keyframes share and the map does not have yet.
#pragma once

#include <vector>

#include "map/map.h"
#include "mapping/mapping_options.h"
#include "optimization/feature_observation.h"

namespace msf {

struct NewPoint {
  Eigen::Vector3d p_w;
  int feature = -1;  // in the new keyframe
  int neighbour_feature = -1;
};

// Matches the free features of two keyframes along their epipolar lines; the place comes from the
// wider of the two parallaxes, between the keyframes (triangulation) or of one keyframe's depth,
// and must agree with both images and with the change of scale. Empty when the two are too close
// together.
std::vector<NewPoint> TriangulateWithNeighbour(const MappingOptions& options,
                                               const NoiseOptions& noise, const Map& map,
                                               KeyFrameId id, KeyFrameId neighbour);

// Puts them into the map unless a feature was taken meanwhile.
std::vector<MapPointId> AddNewPoints(const std::vector<NewPoint>& points, KeyFrameId id,
                                     KeyFrameId neighbour, Map& map);

}  // namespace msf
