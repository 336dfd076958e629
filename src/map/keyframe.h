// A frame that the map keeps.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "feature/bag_of_words.h"
#include "feature/frame_features.h"
#include "geometry/rigid3d.h"
#include "util/strong_id.h"

namespace msf {

struct KeyFrame {
  KeyFrameId id;
  MapId map_id;
  FrameId frame_id;
  double time_s = 0;
  // What the camera saw. Replaced only by Map::SetFeatures.
  std::shared_ptr<const FrameFeatures> features;
  std::shared_ptr<const BagOfWords> words;         // null until mapping has described it
  std::vector<std::array<uint8_t, 3>> colors_bgr;  // per feature

  Rigid3d T_cw;
  std::vector<MapPointId> points;  // per feature, invalid = none

  Eigen::Vector3d CentreInWorld() const { return T_cw.Inverse().translation(); }
};

}  // namespace msf
