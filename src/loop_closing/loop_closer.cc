#include "loop_closing/loop_closer.h"

#include "loop_closing/loop_corrector.h"
#include "loop_closing/map_merger.h"

namespace msf {

LoopCloser::LoopCloser(const LoopClosingOptions& options, const NoiseOptions& noise, SharedMap& map,
                       KeyFrameDatabase& database, uint64_t seed)
    : options_(options),
      noise_(noise),
      map_(map),
      database_(database),
      detector_(options, noise, seed) {}

LoopClosingSummary LoopCloser::Process(KeyFrameId id) {
  LoopClosingSummary summary;
  std::optional<Recognition> place;
  if (options_.enabled) {
    const StageTimer timer(summary.timings_ms, "detect");
    place = detector_.Detect(id, map_, database_);
    summary.attempts = detector_.attempts();
  }
  {
    // After detection: a keyframe is no candidate for itself.
    const StageTimer timer(summary.timings_ms, "register");
    UpdateDatabase(id);
  }
  if (place) {
    const StageTimer timer(summary.timings_ms, "correct");
    Correct(*place, summary);
  }
  return summary;
}

void LoopCloser::UpdateDatabase(KeyFrameId id) {
  std::vector<KeyFrameId> gone;
  std::shared_ptr<const BagOfWords> words;
  {
    const SharedMap::Reader map = map_.Read();
    for (const KeyFrameId known : registered_) {
      if (!map->FindKeyFrame(known)) gone.push_back(known);
    }
    if (const KeyFrame* keyframe = map->FindKeyFrame(id)) words = keyframe->words;
  }
  for (const KeyFrameId culled : gone) {
    database_.Remove(culled);
    registered_.erase(culled);
  }
  if (words && registered_.insert(id).second) database_.Add(id, words);
}

void LoopCloser::Correct(const Recognition& place, LoopClosingSummary& summary) {
  if (place.kind == PlaceKind::kLoop) {
    const std::optional<int> fused = CloseLoop(options_, place, map_);
    if (!fused) return;
    summary.fused_points = *fused;
    summary.wants_full_bundle = map_.Read()->MapOf(place.match.current);
  } else {
    const std::optional<MergeOutcome> merge = MergeMaps(options_, noise_, place, map_);
    if (!merge) return;
    summary.fused_points = merge->fused;
    summary.wants_full_bundle = merge->map_id;
  }
  summary.found = place.kind;
  summary.current = place.match.current;
  summary.matched = place.match.matched;
  summary.inliers = static_cast<int>(place.match.matches.size());
  summary.T_c_m = place.match.T_c_m;
}

}  // namespace msf
