// What tracking knows of one image.
#pragma once

#include <memory>
#include <vector>

#include "feature/bag_of_words.h"
#include "feature/frame_features.h"
#include "geometry/rigid3d.h"
#include "sensor/rgbd_frame.h"

namespace msf {

struct Frame {
  RgbdFramePtr image;
  std::shared_ptr<const FrameFeatures> features;
  std::shared_ptr<const FrameFeatures> removed;  // what seems to move; only to judge the map by
  bool relocalized = false;                      // its pose was found anew, not followed
  bool shutter_left_in = false;                  // a rolling shutter was not undone in either
  std::shared_ptr<const BagOfWords> words;       // null until somebody needs them
  Rigid3d T_cw;
  std::vector<MapPointId> points;  // per feature: the map point it shows; invalid = none
  KeyFrameId reference;            // the keyframe that shares most points
  Rigid3d T_c_reference;  // pose relative to it, which stays true when the map is corrected

  int NumPoints() const {
    int count = 0;
    for (const MapPointId point : points) count += point.valid();
    return count;
  }
};

}  // namespace msf
