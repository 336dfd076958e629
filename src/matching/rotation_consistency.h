// Matches between two images whose patches all turned by about the same angle.
#pragma once

#include <vector>

namespace msf {

// Flags the matches whose change of patch orientation (rad) falls into one of the three most common
// of 30 directions; directions with less than a tenth of the most common one's share do not count.
std::vector<bool> ConsistentRotations(const std::vector<float>& angle_changes_rad);

}  // namespace msf
