// Grows and refines the map around each new keyframe.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "map/shared_map.h"
#include "mapping/local_bundle.h"
#include "mapping/mapping_options.h"
#include "mapping/point_culling.h"
#include "place_recognition/vocabulary.h"
#include "util/stage_timer.h"

namespace msf {

struct MappingSummary {
  int created_points = 0;
  int fused_points = 0;
  std::vector<KeyFrameId> culled_keyframes;
  bool refined = false;  // local bundle adjustment ran to its end
  StageTimings timings_ms;
};

// Single-threaded; may run beside tracking and loop closing, which share the map.
class LocalMapper {
 public:
  LocalMapper(const MappingOptions& options, const NoiseOptions& noise, SharedMap& map,
              std::shared_ptr<const Vocabulary> vocabulary);

  // Takes a keyframe that tracking has put into the map: describes it in words, culls young points,
  // triangulates, and, unless `hurry()` says that more keyframes wait, fuses duplicates, adjusts
  // the neighbourhood and culls redundant keyframes. Keyframes whose map was dropped meanwhile are
  // ignored.
  MappingSummary Process(KeyFrameId id, const std::function<bool()>& hurry);

  // Ends a bundle adjustment that is under way as soon as possible; callable from any thread.
  void Interrupt() { cancel_bundle_ = true; }

 private:
  bool Register(KeyFrameId id);
  void CreatePoints(KeyFrameId id, const std::function<bool()>& hurry, MappingSummary& summary);
  int FuseWithNeighbours(KeyFrameId id);
  std::vector<MapPointId> PointsSeenBy(KeyFrameId id) const;
  int FuseInto(KeyFrameId id, std::span<const MapPointId> points);
  bool RefineNeighbourhood(KeyFrameId id);

  const MappingOptions options_;
  const NoiseOptions noise_;
  SharedMap& map_;
  const std::shared_ptr<const Vocabulary> vocabulary_;
  RecentPoints recent_points_;
  std::atomic<bool> cancel_bundle_ = false;
};

}  // namespace msf
