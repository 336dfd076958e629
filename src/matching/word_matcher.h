// Matches between two images without knowing their poses: only descriptors below the same node of
// the vocabulary are compared.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "feature/bag_of_words.h"
#include "feature/frame_features.h"

namespace msf {

// One side of the comparison. `usable` flags the features that take part; empty: all.
struct WordImage {
  const FrameFeatures& features;
  const BagOfWords& words;
  std::span<const uint8_t> usable;
};

struct WordMatchOptions {
  int max_distance = kStrictDescriptorDistance;
  double ratio = 0.7;          // best against second best
  bool check_rotation = true;  // keep only matches that agree on the turn between the images
};

// Pairs (feature of a, feature of b), each feature at most once, ascending by the feature of a.
std::vector<std::pair<int, int>> MatchByWords(const WordImage& a, const WordImage& b,
                                              const WordMatchOptions& options);

// Calls visit(features of a, features of b) for every node that both images have.
template <typename Visit>
void ForEachCommonNode(const BagOfWords& a, const BagOfWords& b, const Visit& visit) {
  auto node_a = a.nodes.begin();
  auto node_b = b.nodes.begin();
  while (node_a != a.nodes.end() && node_b != b.nodes.end()) {
    if (node_a->first < node_b->first) {
      ++node_a;
    } else if (node_b->first < node_a->first) {
      ++node_b;
    } else {
      visit((node_a++)->second, (node_b++)->second);
    }
  }
}

// Drops the pairs whose patches did not turn with the majority (see rotation_consistency.h).
std::vector<std::pair<int, int>> KeepConsistentRotations(
    const std::vector<std::pair<int, int>>& pairs, const FrameFeatures& a, const FrameFeatures& b);

}  // namespace msf
