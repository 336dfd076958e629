// The vocabulary: a tree that sorts binary descriptors into visual words (Nister and Stewenius,
// CVPR 2006; Galvez-Lopez and Tardos, T-RO 2012).
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "feature/bag_of_words.h"
#include "feature/descriptor.h"
#include "util/status.h"

namespace msf {

// The tree as flat arrays, node 0 is the root, level by level, so that the children of a node are
// neighbours. A node without children is a word; its number is the word's name.
struct VocabularyTree {
  uint32_t branching = 0;
  uint32_t levels = 0;                // the words lie at most this far below the root
  std::vector<Descriptor> centres;    // per node
  std::vector<uint32_t> first_child;  // per node and one more: children of i are first_child[i] ..
                                      // first_child[i + 1] - 1
  std::vector<float>
      weights;  // per node: ln(training images / those that contain the word), 0 for inner nodes

  int num_nodes() const { return static_cast<int>(centres.size()); }
  bool IsWord(uint32_t node) const { return first_child[node] == first_child[node + 1]; }
  // A sentence when the arrays do not make a tree of that form.
  Status Check() const;
};

class Vocabulary {
 public:
  // Descriptors are grouped for matching by their node this far below the root. The same point in
  // two images falls into the same node of level 1, 2, 3 in 75, 51 and 33 % of the cases (TUM fr1,
  // 12 frames apart); 10 groups cost 1/10 of comparing all with all, which is little enough.
  static constexpr int kGroupLevel = 1;

  explicit Vocabulary(VocabularyTree tree);

  // Reads a file that Save() wrote (see vocabulary_file.h); an error names the file and what is
  // wrong with it.
  static StatusOr<Vocabulary> Load(const std::filesystem::path& file);
  Status Save(const std::filesystem::path& file) const;

  const VocabularyTree& tree() const { return tree_; }
  int num_words() const { return num_words_; }

  // The image with these descriptors as words with tf-idf weights, and the indices of the
  // descriptors grouped by node.
  BagOfWords Transform(std::span<const Descriptor> descriptors) const;

 private:
  struct Place {
    uint32_t word = 0;
    uint32_t group = 0;
  };
  Place Descend(const Descriptor& descriptor) const;

  VocabularyTree tree_;
  int num_words_ = 0;
};

}  // namespace msf
