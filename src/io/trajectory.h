// Trajectories and their TUM text form: `timestamp tx ty tz qx qy qz qw`, one camera-to-world pose
// per line.
#pragma once

#include <filesystem>
#include <vector>

#include "geometry/rigid3d.h"
#include "util/status.h"

namespace msf {

struct StampedPose {
  double time_s = 0;
  Rigid3d T_wc;
};

using Trajectory = std::vector<StampedPose>;

// Reads a TUM trajectory; '#' starts a comment. Quaternions are normalised. Errors name file and
// line: a column count other than eight, something that is no finite number, a zero quaternion, a
// time stamp before the previous one; or no pose at all.
StatusOr<Trajectory> ReadTrajectory(const std::filesystem::path& file);

// Writes it atomically: time stamps with 6 decimals, the rest with 9, single spaces.
Status WriteTrajectory(const std::filesystem::path& file, const Trajectory& trajectory);

}  // namespace msf
