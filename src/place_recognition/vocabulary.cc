#include "place_recognition/vocabulary.h"

#include <algorithm>
#include <cmath>

#include "place_recognition/vocabulary_file.h"

namespace msf {
namespace {

// Runs of equal keys in (key, index) pairs sorted by both.
template <typename Pairs, typename Visit>
void ForEachRun(const Pairs& pairs, const Visit& visit) {
  for (size_t begin = 0; begin < pairs.size();) {
    size_t end = begin + 1;
    while (end < pairs.size() && pairs[end].first == pairs[begin].first) ++end;
    visit(pairs[begin].first, begin, end);
    begin = end;
  }
}

}  // namespace

Status VocabularyTree::Check() const {
  const size_t size = centres.size();
  if (size < 1 || first_child.size() != size + 1 || weights.size() != size) {
    return Status::Error("the vocabulary's arrays have unequal lengths");
  }
  // Level by level without gaps: the root's children start at 1 and everybody is somebody's child.
  if (first_child[0] != 1 || first_child[size] != size)
    return Status::Error("the vocabulary's nodes do not form one tree");
  for (size_t node = 0; node < size; ++node) {
    const bool ordered = first_child[node] > node && first_child[node] <= first_child[node + 1];
    if (!ordered) return Status::Error("the vocabulary's nodes are not ordered level by level");
    if (!(std::isfinite(weights[node]) && weights[node] >= 0)) {
      return Status::Error("the vocabulary has a weight that is no number");
    }
  }
  return Status::Ok();
}

Vocabulary::Vocabulary(VocabularyTree tree) : tree_(std::move(tree)) {
  const Status status = tree_.Check();
  MSF_CHECK(status.ok(), status.message());
  for (int node = 0; node < tree_.num_nodes(); ++node) num_words_ += tree_.IsWord(node);
}

StatusOr<Vocabulary> Vocabulary::Load(const std::filesystem::path& file) {
  StatusOr<VocabularyTree> tree = ReadVocabularyFile(file);
  if (!tree.ok()) return tree.status();
  return Vocabulary(*std::move(tree));
}

Status Vocabulary::Save(const std::filesystem::path& file) const {
  return WriteVocabularyFile(tree_, file);
}

BagOfWords Vocabulary::Transform(std::span<const Descriptor> descriptors) const {
  std::vector<std::pair<uint32_t, int>> words(descriptors.size()), groups(descriptors.size());
  for (int i = 0; i < static_cast<int>(descriptors.size()); ++i) {
    const Place place = Descend(descriptors[i]);
    words[i] = {place.word, i};
    groups[i] = {place.group, i};
  }
  std::sort(words.begin(), words.end());
  std::sort(groups.begin(), groups.end());
  BagOfWords bag;
  double sum = 0;
  ForEachRun(words, [&](uint32_t word, size_t begin, size_t end) {
    const float weight = tree_.weights[word] * static_cast<float>(end - begin);
    if (weight <= 0) return;  // a word of every training image says nothing
    bag.words.emplace_back(word, weight);
    sum += weight;
  });
  for (auto& [word, weight] : bag.words) weight = static_cast<float>(weight / sum);
  ForEachRun(groups, [&](uint32_t group, size_t begin, size_t end) {
    std::vector<int>& indices = bag.nodes.emplace_back(group, std::vector<int>()).second;
    indices.reserve(end - begin);
    for (size_t i = begin; i < end; ++i) indices.push_back(groups[i].second);
  });
  return bag;
}

Vocabulary::Place Vocabulary::Descend(const Descriptor& descriptor) const {
  uint32_t node = 0, group = 0;
  for (int level = 0; !tree_.IsWord(node); ++level) {
    if (level == kGroupLevel) group = node;
    uint32_t best = tree_.first_child[node];
    int best_distance = 257;
    for (uint32_t child = best; child < tree_.first_child[node + 1]; ++child) {
      const int distance = DescriptorDistance(descriptor, tree_.centres[child]);
      if (distance < best_distance) {
        best_distance = distance;
        best = child;
      }
    }
    node = best;
  }
  // A word above the group level is a group of its own.
  return {node, group != 0 ? group : node};
}

}  // namespace msf
