#include "loop_closing/full_bundle.h"

#include "loop_closing/map_bundle.h"

namespace msf {
namespace {

constexpr int kMinKeyFrames = 3;

MapBundle CopyMap(const Map& map, const NoiseOptions& noise, MapId map_id) {
  std::vector<KeyFrameId> free, fixed;
  for (const KeyFrameId id : map.KeyFrameIds(map_id)) {
    (map.tree().Parent(id).valid() ? free : fixed).push_back(id);
  }
  return CopyBundle(map, noise, free, fixed);
}

}  // namespace

bool FullBundle::Run(MapId map_id, const std::atomic<bool>& cancel) {
  MapBundle bundle;
  {
    const SharedMap::Reader map = map_.Read();
    if (map->NumKeyFrames(map_id) < kMinKeyFrames) return false;
    bundle = CopyMap(*map, noise_, map_id);
  }
  const Camera camera = map_.Read()->camera();  // a copy: the guard must not outlive this line
  const BundleResult result = SolveBundle(camera, bundle.problem, options_.full_bundle, &cancel);
  if (!result.usable || result.cancelled) return false;
  return ApplyCorrection(CorrectionOf(bundle), *map_.Write());
}

}  // namespace msf
