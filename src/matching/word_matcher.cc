#include "matching/word_matcher.h"

#include <algorithm>
#include <climits>

#include "matching/rotation_consistency.h"

namespace msf {
namespace {

bool Usable(const WordImage& image, int feature) {
  return image.usable.empty() || image.usable[feature];
}

struct Owner {
  int feature = -1;
  int distance = INT_MAX;
};

}  // namespace

std::vector<std::pair<int, int>> MatchByWords(const WordImage& a, const WordImage& b,
                                              const WordMatchOptions& options) {
  std::vector<Owner> owner_of_b(b.features.size());
  ForEachCommonNode(
      a.words, b.words, [&](const std::vector<int>& of_a, const std::vector<int>& of_b) {
        for (const int i : of_a) {
          if (!Usable(a, i)) continue;
          Owner best, second;
          for (const int j : of_b) {
            if (!Usable(b, j)) continue;
            const int distance =
                DescriptorDistance(a.features.descriptors[i], b.features.descriptors[j]);
            if (distance < best.distance) {
              second = best;
              best = {j, distance};
            } else if (distance < second.distance) {
              second = {j, distance};
            }
          }
          if (best.distance > options.max_distance) continue;
          if (second.feature >= 0 && best.distance >= options.ratio * second.distance) continue;
          Owner& owner = owner_of_b[best.feature];
          if (best.distance < owner.distance) owner = {i, best.distance};
        }
      });
  std::vector<std::pair<int, int>> pairs;
  for (int j = 0; j < b.features.size(); ++j) {
    if (owner_of_b[j].feature >= 0) pairs.emplace_back(owner_of_b[j].feature, j);
  }
  std::sort(pairs.begin(), pairs.end());
  return options.check_rotation ? KeepConsistentRotations(pairs, a.features, b.features) : pairs;
}

std::vector<std::pair<int, int>> KeepConsistentRotations(
    const std::vector<std::pair<int, int>>& pairs, const FrameFeatures& a, const FrameFeatures& b) {
  std::vector<float> changes_rad;
  changes_rad.reserve(pairs.size());
  for (const auto& [i, j] : pairs) changes_rad.push_back(a.angle_rad[i] - b.angle_rad[j]);
  const std::vector<bool> consistent = ConsistentRotations(changes_rad);
  std::vector<std::pair<int, int>> kept;
  for (size_t k = 0; k < pairs.size(); ++k) {
    if (consistent[k]) kept.push_back(pairs[k]);
  }
  return kept;
}

}  // namespace msf
