// Trajectories as other systems write them.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "io/trajectory.h"

namespace msf {

// Reads a trajectory in one of these forms, told apart by what the first line looks like:
//   TUM     timestamp[s] tx ty tz qx qy qz qw
//   KITTI   the 12 numbers of a 3x4 matrix [R t], row by row; line i is the pose of frame i, whose
//           time is `frame_times_s[i]`
//   EuRoC   timestamp[ns], px, py, pz, qw, qx, qy, qz and any further columns, separated by commas;
//           or TUM's columns with the time in ns, as ORB-SLAM3 writes it
// Poses are taken as camera to world. Errors name file and line.
StatusOr<Trajectory> ReadForeignTrajectory(const std::filesystem::path& file,
                                           std::span<const double> frame_times_s);

}  // namespace msf
