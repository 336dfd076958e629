// Clustering of binary descriptors.
#pragma once

#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "feature/descriptor.h"

namespace msf {

struct BinaryClusters {
  std::vector<Descriptor> centres;
  std::vector<int> members;  // per descriptor: its centre; every centre has at least one
};

// At most `count` clusters by k-majority (k-means with Hamming distance, a centre's bit is what
// most of its members have), started as in k-means++ (Arthur and Vassilvitskii, 2007). Fewer when
// there are fewer distinct descriptors. Needs at least one.
BinaryClusters ClusterBinary(std::span<const Descriptor> descriptors, int count, int max_iterations,
                             std::mt19937_64& random);

}  // namespace msf
