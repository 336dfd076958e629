// A point of the world that keyframes have seen.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "feature/descriptor.h"
#include "util/strong_id.h"

namespace msf {

struct Observation {
  KeyFrameId keyframe;
  int feature = -1;
};

struct MapPoint {
  MapPointId id;
  MapId map_id;
  Eigen::Vector3d p_w = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal =
      Eigen::Vector3d::Zero();  // mean direction from the observers to the point, unit length
  double min_distance_m = 0;    // range in which the point is seen within the pyramid
  double max_distance_m = 0;
  Descriptor descriptor{};
  float static_weight = 1;  // probability that the point belongs to the static world
  std::array<uint8_t, 3> color_bgr{};
  KeyFrameId first_keyframe;              // the keyframe that created it
  KeyFrameId reference;                   // the keyframe whose distance defines the range
  std::vector<Observation> observations;  // ascending by keyframe

  // How well the place is known: an observation with depth counts twice, as the virtual second
  // camera saw it too.
  int observation_strength = 0;
  int visible_count = 1;  // frames in which it should have been seen
  int found_count = 1;    // frames in which it was
  double FoundRatio() const { return static_cast<double>(found_count) / visible_count; }

  // The feature by which `keyframe` sees this point, -1 = it does not.
  int FeatureIn(KeyFrameId keyframe) const {
    for (const Observation& observation : observations) {
      if (observation.keyframe == keyframe) return observation.feature;
    }
    return -1;
  }
};

}  // namespace msf
