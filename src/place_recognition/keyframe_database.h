// Which keyframes look like a given image: an inverted index from visual words to keyframes.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <unordered_map>
#include <vector>

#include "feature/bag_of_words.h"
#include "util/strong_id.h"

namespace msf {

// May be used from several threads at once. Calls the functions that it is given without holding
// its lock. Results depend only on the content, never on the order in which it came.
class KeyFrameDatabase {
 public:
  // The (about 10) keyframes that share most points with one.
  using Neighbours = std::function<std::vector<KeyFrameId>(KeyFrameId)>;

  // Replaces what was known about the keyframe.
  void Add(KeyFrameId id, std::shared_ptr<const BagOfWords> words);
  // A keyframe that is not there is none to remove.
  void Remove(KeyFrameId id);
  int size() const;

  // Keyframes where the image may have been taken, most likely first. Those with at least 0.8 of
  // the most words that any shares with the image are scored; each one's score is summed over it
  // and its neighbours; groups with at least 0.75 of the best sum contribute their best keyframe
  // (Mur-Artal and Tardos, ICRA 2014).
  std::vector<KeyFrameId> RelocalizationCandidates(const BagOfWords& image,
                                                   const Neighbours& neighbours) const;

  // The up to `count` best keyframes, by the same sums, among those that are not `excluded` (the
  // keyframe itself and all that see what it sees) and that `accept` wants (same map for loops,
  // others for merging; empty: all).
  std::vector<KeyFrameId> PlaceCandidates(const BagOfWords& image,
                                          const std::set<KeyFrameId>& excluded,
                                          const std::function<bool(KeyFrameId)>& accept,
                                          const Neighbours& neighbours, int count) const;

 private:
  struct Entry {
    KeyFrameId id;
    std::shared_ptr<const BagOfWords> words;  // null: free place
  };
  struct Sharing {
    KeyFrameId id;
    int num_words = 0;
    std::shared_ptr<const BagOfWords> words;
  };

  // All keyframes that share a word with the image, by id.
  std::vector<Sharing> FindSharing(const BagOfWords& image) const;
  void RemoveLocked(KeyFrameId id);

  mutable std::mutex mutex_;
  std::vector<Entry> entries_;
  std::vector<int> free_;
  std::map<KeyFrameId, int> entry_of_;
  std::unordered_map<uint32_t, std::vector<int>> entries_with_word_;
};

}  // namespace msf
