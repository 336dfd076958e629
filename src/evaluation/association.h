// Which true pose belongs to which estimated pose.
#pragma once

#include <vector>

#include "io/trajectory.h"

namespace msf {

// An estimated pose and the true one of the same moment, each in its own world.
struct PosePair {
  double time_s = 0;  // the estimate's time stamp
  Rigid3d estimated_T_wc;
  Rigid3d true_T_wc;
};

inline constexpr double kMaxAssociationGap_s = 0.02;

// For each estimated pose the nearest true one in time, if it is at most `max_gap_s` away; in order
// of time. Where the estimate is the longer one of the two, it is for each true pose the nearest
// estimated one: evo's rule, whose figures ours equal.
std::vector<PosePair> AssociateTrajectories(const Trajectory& truth, const Trajectory& estimate,
                                            double max_gap_s = kMaxAssociationGap_s);

}  // namespace msf
