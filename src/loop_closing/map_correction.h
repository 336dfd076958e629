// A correction of a whole map, solved from a copy and brought into the map as it is by then.
#pragma once

#include <map>
#include <vector>

#include "map/map.h"

namespace msf {

// How the world moves as each keyframe sees it: p_new = motion * p_old. What joined the map after
// the copy was made, or was refined meanwhile, moves along.
struct MapCorrection {
  struct Point {
    MapPointId id;
    Eigen::Vector3d before_w, after_w;
  };

  MapId map_id;
  uint64_t epoch = 0;  // of the map when it was copied
  std::map<KeyFrameId, Rigid3d> motion;
  // Points with a solution of their own; the others move with their reference keyframe.
  std::vector<Point> points;
};

// Moves every keyframe of the map: by its own motion, else with its nearest ancestor in the
// spanning tree that has one. Every point moves with its reference keyframe, unless it still is
// where a solution found it: then it goes where the solution puts it. Starts a new epoch. Nothing
// happens, and it returns false, when another whole-map correction came first.
bool ApplyCorrection(const MapCorrection& correction, Map& map);

// The motion of the world that takes a keyframe from one pose to another.
inline Rigid3d MotionBetween(const Rigid3d& T_cw_before, const Rigid3d& T_cw_after) {
  return T_cw_after.Inverse() * T_cw_before;
}

}  // namespace msf
