// The part of the map around the camera: what the present frame is matched against.
#pragma once

#include <vector>

#include "map/map.h"
#include "matching/point_projection.h"
#include "tracking/frame.h"

namespace msf {

class LocalMap {
 public:
  // The keyframes that share most points with the frame and, of each of them, one more among its
  // `max_neighbours` best, one child and the parent, `max_keyframes` in all (two more at most); and
  // a copy of all their points. The copy is reused as long as neither the keyframes nor the map
  // change.
  void Update(const Map& map, const Frame& frame, int max_keyframes, int max_neighbours);

  // Ascending by id.
  const std::vector<PointSnapshot>& points() const { return points_; }
  // The keyframe that shares most points with the frame; invalid when none does.
  KeyFrameId best_keyframe() const { return best_keyframe_; }
  // Its pose when the points were copied.
  const Rigid3d& T_cw_best_keyframe() const { return T_cw_best_keyframe_; }
  const std::vector<KeyFrameId>& keyframes() const { return keyframes_; }
  void Clear();

 private:
  std::vector<KeyFrameId> SelectKeyFrames(const Map& map, const Frame& frame, int max_keyframes,
                                          int max_neighbours);
  void CopyPoints(const Map& map);

  std::vector<KeyFrameId> keyframes_;
  std::vector<PointSnapshot> points_;
  KeyFrameId best_keyframe_;
  Rigid3d T_cw_best_keyframe_;
  uint64_t map_version_ = 0;
  uint64_t map_weights_version_ = 0;
};

}  // namespace msf
