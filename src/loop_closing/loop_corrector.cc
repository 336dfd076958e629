#include "loop_closing/loop_corrector.h"

#include "loop_closing/map_pose_graph.h"
#include "loop_closing/seam_fusion.h"

namespace msf {
namespace {

// A full bundle adjustment may finish while the pose graph is solved: then it starts again from
// there. It cannot happen often in a row.
constexpr int kMaxAttempts = 3;

std::optional<MapPoseGraph> CopyWithLoop(const LoopClosingOptions& options, const Recognition& loop,
                                         const SharedMap& shared_map) {
  const SharedMap::Reader map = shared_map.Read();
  const KeyFrame* current = map->FindKeyFrame(loop.match.current);
  const KeyFrame* matched = map->FindKeyFrame(loop.match.matched);
  if (!current || !matched || current->map_id != matched->map_id) return std::nullopt;
  MapPoseGraph copy =
      CopyPoseGraph(*map, map->KeyFrameIds(current->map_id), options.strong_covisibility);
  copy.AddEdge(loop.match.current, loop.match.matched, loop.match.T_c_m);
  for (const PlaceMatch& match : loop.supporting) {
    copy.AddEdge(match.current, match.matched, match.T_c_m);
  }
  return copy;
}

bool Bend(const LoopClosingOptions& options, const Recognition& loop, SharedMap& shared_map) {
  for (int attempt = 0; attempt < kMaxAttempts; ++attempt) {
    std::optional<MapPoseGraph> copy = CopyWithLoop(options, loop, shared_map);
    if (!copy || !SolvePoseGraph(copy->graph, options.pose_graph).usable) return false;
    const MapCorrection correction = CorrectionOf(*copy);
    const SharedMap::Writer map = shared_map.Write();
    const bool both_present =
        map->FindKeyFrame(loop.match.current) && map->FindKeyFrame(loop.match.matched);
    if (!both_present) return false;
    if (!ApplyCorrection(correction, *map)) continue;
    map->AddLoopEdge(loop.match.current, loop.match.matched);
    return true;
  }
  return false;
}

}  // namespace

std::optional<int> CloseLoop(const LoopClosingOptions& options, const Recognition& loop,
                             SharedMap& map) {
  const std::optional<Seam> seam = FindSeam(options, loop, *map.Read());
  if (!seam || !Bend(options, loop, map)) return std::nullopt;
  return FuseSeam(options, loop, *seam, map);
}

}  // namespace msf
