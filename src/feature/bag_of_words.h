// An image as a bag of visual words: what place recognition compares and what narrows descriptor
// matching down.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace msf {

struct BagOfWords {
  // (word, weight), ascending by word, weights sum to 1.
  std::vector<std::pair<uint32_t, float>> words;
  // (node of the tree near the leaves, indices of the points below it), ascending by node.
  std::vector<std::pair<uint32_t, std::vector<int>>> nodes;

  bool empty() const { return words.empty(); }
};

}  // namespace msf
