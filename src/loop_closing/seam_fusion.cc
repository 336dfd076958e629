#include "loop_closing/seam_fusion.h"

#include <algorithm>

#include "loop_closing/duplicate_fusion.h"

namespace msf {
namespace {

std::vector<KeyFrameId> WithNeighbours(const Map& map, KeyFrameId centre, int max_keyframes) {
  std::vector<KeyFrameId> keyframes = map.covisibility().Best(centre, max_keyframes - 1);
  keyframes.insert(keyframes.begin(), centre);
  return keyframes;
}

int FuseVerified(const PlaceMatch& match, SharedMap& shared_map) {
  const SharedMap::Writer map = shared_map.Write();
  return map->FindKeyFrame(match.current) ? FuseMatches(match.matches, match.current, *map) : 0;
}

}  // namespace

std::optional<Seam> FindSeam(const LoopClosingOptions& options, const Recognition& place,
                             const Map& map) {
  if (!map.FindKeyFrame(place.match.current) || !map.FindKeyFrame(place.match.matched))
    return std::nullopt;
  Seam seam;
  seam.matched = WithNeighbours(map, place.match.matched, options.max_seam_keyframes);
  for (const KeyFrameId id : WithNeighbours(map, place.match.current, options.max_seam_keyframes)) {
    const bool on_both =
        std::find(seam.matched.begin(), seam.matched.end(), id) != seam.matched.end();
    if (!on_both) seam.current.push_back(id);
  }
  return seam;
}

int FuseSeam(const LoopClosingOptions& options, const Recognition& place, const Seam& seam,
             SharedMap& shared_map) {
  int fused = FuseVerified(place.match, shared_map);
  for (const PlaceMatch& match : place.supporting) fused += FuseVerified(match, shared_map);
  const std::vector<MapPointId> established = shared_map.Read()->PointsSeenBy(seam.matched);
  for (const KeyFrameId id : seam.current) {
    const SharedMap::Writer map = shared_map.Write();
    if (map->FindKeyFrame(id))
      fused += FuseIntoKeyFrame(established, id, options.fuse_radius_px, *map);
  }
  const SharedMap::Writer map = shared_map.Write();
  for (const KeyFrameId id : seam.current) {
    if (map->FindKeyFrame(id)) map->UpdateConnections(id);
  }
  for (const MapPointId id : map->PointsSeenBy(seam.current)) {
    map->UpdateAppearance(id);
    map->UpdateNormalAndRange(id);
  }
  return fused;
}

}  // namespace msf
