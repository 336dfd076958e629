// Recognises places: in the present map they close loops, in other maps they join the maps.
#pragma once

#include <optional>
#include <vector>

#include "loop_closing/place_verification.h"
#include "loop_closing/recognition.h"
#include "map/shared_map.h"
#include "place_recognition/keyframe_database.h"

namespace msf {

// Single-threaded; looks at each keyframe once, in order.
class LoopDetector {
 public:
  LoopDetector(const LoopClosingOptions& options, const NoiseOptions& noise, uint64_t seed)
      : options_(options), noise_(noise), seed_(seed) {}

  // Whether `id` was taken where its map, or another map, has been before. A place found by too
  // few keyframes is remembered until the next ones confirm it, or do not.
  std::optional<Recognition> Detect(KeyFrameId id, const SharedMap& map,
                                    const KeyFrameDatabase& database);

  // The candidates that the last Detect() compared, accepted or not.
  const std::vector<PlaceAttempt>& attempts() const { return attempts_; }

 private:
  // A place that still lacks agreement.
  struct Hypothesis {
    Recognition place;
    int missed = 0;  // keyframes in a row that did not agree
  };
  std::optional<Recognition> Look(PlaceKind kind, const PlaceWindow& current, const SharedMap& map,
                                  const KeyFrameDatabase& database,
                                  std::optional<Hypothesis>& hypothesis);
  std::vector<KeyFrameId> Candidates(PlaceKind kind, const PlaceWindow& current, const Map& map,
                                     const KeyFrameDatabase& database) const;
  // The candidate that the current keyframe matches best.
  std::optional<Hypothesis> Suppose(PlaceKind kind, const std::vector<KeyFrameId>& candidates,
                                    const PlaceWindow& current, const SharedMap& map);
  // Asks the current keyframe about a place that former ones have found; false: give it up.
  bool FollowUp(const PlaceWindow& current, const SharedMap& map, Hypothesis& hypothesis);
  // Notes the outcome for attempts().
  void Note(const Recognition& place);
  bool IsPlausible(const PlaceMatch& match, const Map& map) const;

  const LoopClosingOptions options_;
  const NoiseOptions noise_;
  const uint64_t seed_;
  std::optional<Hypothesis> loop_, merge_;
  KeyFrameId last_loop_;
  std::vector<PlaceAttempt> attempts_;
};

}  // namespace msf
