// Making a vocabulary from example images.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "feature/descriptor.h"
#include "place_recognition/vocabulary.h"
#include "util/status.h"

namespace msf {

struct VocabularyTrainingOptions {
  int branching = 10;
  int levels = 5;
  int max_iterations = 10;  // of every clustering
  uint64_t seed = 1;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("branching", branching, "children of a node");
    visit("levels", levels, "levels below the root");
    visit("max_iterations", max_iterations, "rounds of every clustering");
    visit("seed", seed, "of the random choices");
  }
  Status Check() const;
};

// Clusters the descriptors of all images (one vector per image) into a tree: level by level, the
// members of each node into `branching` children. `progress(done, total)` is called now and then.
// An error when there is nothing to learn from.
StatusOr<Vocabulary> TrainVocabulary(const std::vector<std::vector<Descriptor>>& images,
                                     const VocabularyTrainingOptions& options,
                                     const std::function<void(int, int)>& progress);

}  // namespace msf
