// The order in which bundle adjustment walks through its observations.
#pragma once

#include <cstdint>
#include <vector>

namespace msf {

struct BundleProblem;

// Active observations grouped by point, because eliminating a point needs all its observations at
// once.
struct BundleLayout {
  struct Place {
    int observation;  // index in the problem
    int slot;         // of the observing pose
  };

  // `active`: per observation of the problem.
  BundleLayout(const BundleProblem& problem, const std::vector<uint8_t>& active);

  int num_free_poses = 0;
  std::vector<int> slot;      // per pose: its place among the free poses, -1 when it is fixed
  std::vector<Place> places;  // the active observations, by point and within a point by slot
  std::vector<int> begin;     // per point its first place, and the end
};

}  // namespace msf
