#include "place_recognition/keyframe_database.h"

#include <algorithm>

#include "place_recognition/similarity.h"

namespace msf {
namespace {

constexpr double kCommonWordShare = 0.8;
constexpr double kGroupScoreShare = 0.75;

struct Scored {
  KeyFrameId id;
  double score = 0;
};

// Higher scores first, then lower ids.
bool Better(const Scored& a, const Scored& b) {
  return a.score != b.score ? a.score > b.score : a.id < b.id;
}

// For each keyframe the sum of scores over it and its neighbours, with the best of them; each best
// keyframe once, best sums first.
std::vector<Scored> AccumulateOverNeighbours(const std::map<KeyFrameId, double>& scores,
                                             const KeyFrameDatabase::Neighbours& neighbours) {
  std::map<KeyFrameId, double> sum_of_best;
  for (const auto& [id, score] : scores) {
    Scored best{id, score};
    double sum = score;
    for (const KeyFrameId neighbour : neighbours(id)) {
      const auto found = scores.find(neighbour);
      if (found == scores.end() || neighbour == id) continue;
      sum += found->second;
      if (Better({neighbour, found->second}, best)) best = {neighbour, found->second};
    }
    double& known = sum_of_best[best.id];
    known = std::max(known, sum);
  }
  std::vector<Scored> groups;
  groups.reserve(sum_of_best.size());
  for (const auto& [id, sum] : sum_of_best) groups.push_back({id, sum});
  std::sort(groups.begin(), groups.end(), Better);
  return groups;
}

// Scores of the keyframes that share nearly as many words with the image as the one that shares
// most.
template <typename Sharings>
std::map<KeyFrameId, double> ScoreLikely(const BagOfWords& image, const Sharings& sharings) {
  int most = 0;
  for (const auto& sharing : sharings) most = std::max(most, sharing.num_words);
  std::map<KeyFrameId, double> scores;
  for (const auto& sharing : sharings) {
    if (sharing.num_words >= kCommonWordShare * most)
      scores[sharing.id] = SimilarityScore(image, *sharing.words);
  }
  return scores;
}

}  // namespace

void KeyFrameDatabase::Add(KeyFrameId id, std::shared_ptr<const BagOfWords> words) {
  const std::lock_guard lock(mutex_);
  RemoveLocked(id);
  if (free_.empty()) {
    free_.push_back(static_cast<int>(entries_.size()));
    entries_.emplace_back();
  }
  const int entry = free_.back();
  free_.pop_back();
  for (const auto& [word, weight] : words->words) entries_with_word_[word].push_back(entry);
  entries_[entry] = {id, std::move(words)};
  entry_of_[id] = entry;
}

void KeyFrameDatabase::Remove(KeyFrameId id) {
  const std::lock_guard lock(mutex_);
  RemoveLocked(id);
}

void KeyFrameDatabase::RemoveLocked(KeyFrameId id) {
  const auto found = entry_of_.find(id);
  if (found == entry_of_.end()) return;
  const int entry = found->second;
  for (const auto& [word, weight] : entries_[entry].words->words)
    std::erase(entries_with_word_[word], entry);
  entries_[entry] = {};
  free_.push_back(entry);
  entry_of_.erase(found);
}

int KeyFrameDatabase::size() const {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(entry_of_.size());
}

std::vector<KeyFrameDatabase::Sharing> KeyFrameDatabase::FindSharing(
    const BagOfWords& image) const {
  const std::lock_guard lock(mutex_);
  std::vector<int> num_words(entries_.size(), 0);
  for (const auto& [word, weight] : image.words) {
    const auto found = entries_with_word_.find(word);
    if (found == entries_with_word_.end()) continue;
    for (const int entry : found->second) ++num_words[entry];
  }
  std::vector<Sharing> sharing;
  for (const auto& [id, entry] : entry_of_) {
    if (num_words[entry] > 0) sharing.push_back({id, num_words[entry], entries_[entry].words});
  }
  return sharing;
}

std::vector<KeyFrameId> KeyFrameDatabase::RelocalizationCandidates(
    const BagOfWords& image, const Neighbours& neighbours) const {
  const std::vector<Scored> groups =
      AccumulateOverNeighbours(ScoreLikely(image, FindSharing(image)), neighbours);
  std::vector<KeyFrameId> candidates;
  for (const Scored& group : groups) {
    if (group.score >= kGroupScoreShare * groups.front().score) candidates.push_back(group.id);
  }
  return candidates;
}

std::vector<KeyFrameId> KeyFrameDatabase::PlaceCandidates(
    const BagOfWords& image, const std::set<KeyFrameId>& excluded,
    const std::function<bool(KeyFrameId)>& accept, const Neighbours& neighbours, int count) const {
  std::vector<Sharing> sharing = FindSharing(image);
  std::erase_if(sharing, [&](const Sharing& s) {
    return excluded.contains(s.id) || (accept && !accept(s.id));
  });
  const std::vector<Scored> groups =
      AccumulateOverNeighbours(ScoreLikely(image, sharing), neighbours);
  std::vector<KeyFrameId> candidates;
  for (const Scored& group : groups) {
    if (static_cast<int>(candidates.size()) < count) candidates.push_back(group.id);
  }
  return candidates;
}

}  // namespace msf
