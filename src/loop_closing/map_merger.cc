#include "loop_closing/map_merger.h"

#include <algorithm>

#include "loop_closing/map_bundle.h"
#include "loop_closing/map_pose_graph.h"
#include "loop_closing/seam_fusion.h"

namespace msf {
namespace {

// The two maps as they are before they become one.
struct Joint {
  MapId older;
  std::vector<KeyFrameId> younger_keyframes;
  std::vector<KeyFrameId> younger_seam, older_seam;
};

// Moves the younger map to the older one and hangs its spanning tree below the matched keyframe.
Joint Join(const Recognition& place, const Seam& seam, Map& map) {
  const KeyFrame& current = *map.FindKeyFrame(place.match.current);
  const KeyFrame& matched = *map.FindKeyFrame(place.match.matched);
  const bool current_is_younger = matched.map_id < current.map_id;
  const KeyFrame& young = current_is_younger ? current : matched;
  const KeyFrame& old = current_is_younger ? matched : current;
  const Rigid3d T_young_old = current_is_younger ? place.match.T_c_m : place.match.T_c_m.Inverse();

  Joint joint;
  joint.older = old.map_id;
  joint.younger_keyframes = map.KeyFrameIds(young.map_id);
  joint.younger_seam = current_is_younger ? seam.current : seam.matched;
  joint.older_seam = current_is_younger ? seam.matched : seam.current;
  // Where the young keyframe belongs in the old world, against where it is in its own.
  const Rigid3d T_old_world = old.T_cw.Inverse() * T_young_old.Inverse() * young.T_cw;
  map.MoveMap(young.map_id, joint.older, T_old_world);
  map.MakeRoot(young.id);
  map.SetParent(young.id, old.id);
  map.AddLoopEdge(young.id, old.id);
  map.StartNewEpoch();
  return joint;
}

std::vector<KeyFrameId> StillThere(const std::vector<KeyFrameId>& ids, const Map& map) {
  std::vector<KeyFrameId> present;
  std::copy_if(ids.begin(), ids.end(), std::back_inserter(present),
               [&](KeyFrameId id) { return map.FindKeyFrame(id) != nullptr; });
  return present;
}

// Adjusts the younger side of the seam against the older one; the rest of the younger map follows.
void Weld(const LoopClosingOptions& options, const NoiseOptions& noise, const Joint& joint,
          SharedMap& shared_map) {
  MapBundle bundle;
  MapPoseGraph rest;
  {
    const SharedMap::Reader map = shared_map.Read();
    bundle = CopyBundle(*map, noise, StillThere(joint.younger_seam, *map),
                        StillThere(joint.older_seam, *map));
    rest =
        CopyPoseGraph(*map, StillThere(joint.younger_keyframes, *map), options.strong_covisibility);
  }
  const Camera camera =
      shared_map.Read()->camera();  // a copy: the guard must not outlive this line
  if (!SolveBundle(camera, bundle.problem, options.weld).usable) return;
  for (size_t k = 0; k < bundle.keyframes.size(); ++k) {
    const auto node = rest.node_of.find(bundle.keyframes[k]);
    if (node != rest.node_of.end())
      rest.graph.nodes[node->second] = {bundle.problem.poses[k].T_cw, true};
  }
  MapCorrection correction = CorrectionOf(bundle);
  if (SolvePoseGraph(rest.graph, options.pose_graph).usable)
    correction.motion.merge(CorrectionOf(rest).motion);
  ApplyCorrection(correction, *shared_map.Write());
}

}  // namespace

std::optional<MergeOutcome> MergeMaps(const LoopClosingOptions& options, const NoiseOptions& noise,
                                      const Recognition& place, SharedMap& shared_map) {
  std::optional<Seam> seam;
  Joint joint;
  {
    const SharedMap::Writer map = shared_map.Write();
    seam = FindSeam(options, place, *map);
    if (!seam) return std::nullopt;
    if (map->MapOf(place.match.current) == map->MapOf(place.match.matched)) return std::nullopt;
    joint = Join(place, *seam, *map);
  }
  const int fused = FuseSeam(options, place, *seam, shared_map);
  Weld(options, noise, joint, shared_map);
  return MergeOutcome{joint.older, fused};
}

}  // namespace msf
