#include "mapping/local_mapper.h"

#include <algorithm>
#include <set>

#include "mapping/keyframe_culling.h"
#include "mapping/point_creation.h"
#include "mapping/point_fusion.h"

namespace msf {
namespace {

// First neighbours, then some of theirs: where duplicates of a keyframe's points can be.
std::vector<KeyFrameId> FusionTargets(const Map& map, KeyFrameId id,
                                      const MappingOptions& options) {
  std::vector<KeyFrameId> targets;
  std::set<KeyFrameId> seen = {id};
  const auto add = [&](const std::vector<KeyFrameId>& candidates) {
    for (const KeyFrameId candidate : candidates) {
      if (seen.insert(candidate).second) targets.push_back(candidate);
    }
  };
  const std::vector<KeyFrameId> first = map.covisibility().Best(id, options.num_neighbours);
  add(first);
  for (const KeyFrameId neighbour : first)
    add(map.covisibility().Best(neighbour, options.num_second_neighbours));
  return targets;
}

std::vector<MapPointId> ValidPoints(const KeyFrame& keyframe) {
  std::vector<MapPointId> points;
  std::copy_if(keyframe.points.begin(), keyframe.points.end(), std::back_inserter(points),
               [](MapPointId id) { return id.valid(); });
  return points;
}

}  // namespace

LocalMapper::LocalMapper(const MappingOptions& options, const NoiseOptions& noise, SharedMap& map,
                         std::shared_ptr<const Vocabulary> vocabulary)
    : options_(options), noise_(noise), map_(map), vocabulary_(std::move(vocabulary)) {}

MappingSummary LocalMapper::Process(KeyFrameId id, const std::function<bool()>& hurry) {
  MappingSummary summary;
  cancel_bundle_ = false;
  {
    const StageTimer timer(summary.timings_ms, "register");
    if (!Register(id)) return summary;
  }
  {
    const StageTimer timer(summary.timings_ms, "create_points");
    CreatePoints(id, hurry, summary);
  }
  if (hurry()) return summary;
  {
    const StageTimer timer(summary.timings_ms, "fuse");
    summary.fused_points = FuseWithNeighbours(id);
  }
  if (hurry()) return summary;
  {
    const StageTimer timer(summary.timings_ms, "bundle");
    summary.refined = RefineNeighbourhood(id);
  }
  const StageTimer timer(summary.timings_ms, "cull_keyframes");
  const SharedMap::Writer map = map_.Write();
  if (map->FindKeyFrame(id)) summary.culled_keyframes = CullRedundantKeyFrames(options_, id, *map);
  return summary;
}

bool LocalMapper::Register(KeyFrameId id) {
  std::shared_ptr<const FrameFeatures> features;
  std::shared_ptr<const BagOfWords> words;
  {
    const SharedMap::Reader map = map_.Read();
    const KeyFrame* keyframe = map->FindKeyFrame(id);
    if (!keyframe) return false;
    features = keyframe->features;
    words = keyframe->words;
  }
  if (!words)
    words = std::make_shared<const BagOfWords>(vocabulary_->Transform(features->descriptors));

  const SharedMap::Writer map = map_.Write();
  const KeyFrame* keyframe = map->FindKeyFrame(id);
  if (!keyframe) return false;
  map->SetWords(id, std::move(words));
  for (const MapPointId point : ValidPoints(*keyframe)) {
    if (map->FindPoint(point)->first_keyframe == id) {
      recent_points_.Add(point);
    } else {
      map->UpdateAppearance(point);
      map->UpdateNormalAndRange(point);
    }
  }
  map->UpdateConnections(id);
  recent_points_.Cull(options_, id, *map);
  CullMovingPoints(options_, id, *map);
  return true;
}

void LocalMapper::CreatePoints(KeyFrameId id, const std::function<bool()>& hurry,
                               MappingSummary& summary) {
  const std::vector<KeyFrameId> neighbours =
      map_.Read()->covisibility().Best(id, options_.num_neighbours);
  for (const KeyFrameId neighbour : neighbours) {
    if (summary.created_points > 0 && hurry()) return;
    const std::vector<NewPoint> points =
        TriangulateWithNeighbour(options_, noise_, *map_.Read(), id, neighbour);
    const SharedMap::Writer map = map_.Write();
    for (const MapPointId point : AddNewPoints(points, id, neighbour, *map)) {
      recent_points_.Add(point);
      ++summary.created_points;
    }
  }
}

int LocalMapper::FuseWithNeighbours(KeyFrameId id) {
  int fused = 0;
  std::vector<KeyFrameId> targets;
  {
    const SharedMap::Reader map = map_.Read();
    if (!map->FindKeyFrame(id)) return 0;
    targets = FusionTargets(*map, id, options_);
  }
  std::vector<MapPointId> theirs;
  for (const KeyFrameId target : targets) {
    fused += FuseInto(target, PointsSeenBy(id));
    const std::vector<MapPointId> points = PointsSeenBy(target);
    theirs.insert(theirs.end(), points.begin(), points.end());
  }
  std::sort(theirs.begin(), theirs.end());
  theirs.erase(std::unique(theirs.begin(), theirs.end()), theirs.end());
  fused += FuseInto(id, theirs);
  const SharedMap::Writer map = map_.Write();
  if (!map->FindKeyFrame(id)) return fused;
  for (const MapPointId point : ValidPoints(*map->FindKeyFrame(id))) {
    map->UpdateAppearance(point);
    map->UpdateNormalAndRange(point);
  }
  map->UpdateConnections(id);
  return fused;
}

std::vector<MapPointId> LocalMapper::PointsSeenBy(KeyFrameId id) const {
  const SharedMap::Reader map = map_.Read();
  const KeyFrame* keyframe = map->FindKeyFrame(id);
  return keyframe ? ValidPoints(*keyframe) : std::vector<MapPointId>();
}

// Tracking reads the map meanwhile: only what has been found is written under the writer's guard.
int LocalMapper::FuseInto(KeyFrameId id, std::span<const MapPointId> points) {
  std::vector<PointSighting> sightings;
  {
    const SharedMap::Reader map = map_.Read();
    if (!map->FindKeyFrame(id)) return 0;
    sightings = FindPointsAgain(noise_, points, id, options_.fuse_radius_px, *map);
  }
  const SharedMap::Writer map = map_.Write();
  return map->FindKeyFrame(id) ? FusePoints(sightings, id, *map) : 0;
}

bool LocalMapper::RefineNeighbourhood(KeyFrameId id) {
  LocalBundle bundle;
  {
    const SharedMap::Reader map = map_.Read();
    const KeyFrame* keyframe = map->FindKeyFrame(id);
    if (!keyframe || map->NumKeyFrames(keyframe->map_id) < 3) return false;
    bundle = CopyLocalBundle(options_, noise_, *map, id);
  }
  const Camera camera = map_.Read()->camera();  // a copy: the guard must not outlive this line
  const BundleResult result = SolveBundle(camera, bundle.problem, options_.bundle, &cancel_bundle_);
  ApplyLocalBundle(bundle, result, *map_.Write());
  return result.usable && !result.cancelled;
}

}  // namespace msf
