// The world so far: all keyframes and points of all maps of the atlas, and how they hang together.
// Not thread-safe by itself; threads share it through SharedMap.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "feature/scale_levels.h"
#include "map/covisibility_graph.h"
#include "map/keyframe.h"
#include "map/map_point.h"
#include "map/spanning_tree.h"
#include "sensor/camera.h"

namespace msf {

// Ids count up from 0 and are never used again, so that whoever kept one can always learn what
// became of it.
class Map {
 public:
  Map(std::shared_ptr<const Camera> camera, ScaleLevels levels)
      : camera_(std::move(camera)), levels_(std::move(levels)) {}

  const Camera& camera() const { return *camera_; }
  const ScaleLevels& levels() const { return levels_; }
  // Grows with every change but those of static weights, which have a count of their own: who
  // caches something compares them.
  uint64_t version() const { return version_; }
  uint64_t weights_version() const { return weights_version_; }
  // Grows when the map is corrected as a whole (loop, merge, full bundle adjustment): what a solver
  // computed from an older copy must not be applied any more.
  uint64_t epoch() const { return epoch_; }
  void StartNewEpoch() { ++epoch_; }

  // --- Atlas: the map that tracking extends, and the older ones.
  MapId StartNewMap();
  MapId active_map() const { return active_map_; }
  void SetActiveMap(MapId id) { active_map_ = id; }
  // Forgets a map with all its keyframes and points.
  void DropMap(MapId id);
  // Moves the keyframes and points of `from` by T_to_from (from-world to to-world) and makes them
  // part of `to`.
  void MoveMap(MapId from, MapId to, const Rigid3d& T_to_from);
  std::vector<MapId> MapIds() const;

  // --- Keyframes. Lookups of an id that is gone return nullptr.
  // Adds `keyframe` (its id and points are set here) to the active map, without points yet.
  KeyFrameId AddKeyFrame(KeyFrame keyframe);
  const KeyFrame* FindKeyFrame(KeyFrameId id) const;
  std::vector<KeyFrameId> KeyFrameIds(MapId map) const;
  std::vector<KeyFrameId> KeyFrameIds() const;
  int NumKeyFrames(MapId map) const;
  void SetPose(KeyFrameId id, const Rigid3d& T_cw);
  // The same features in better places, as many in the same order.
  void SetFeatures(KeyFrameId id, std::shared_ptr<const FrameFeatures> features);
  // T_cw of a keyframe, also of one that was culled (it moves with the one it was attached to).
  // Only for ids of this map.
  Rigid3d PoseOf(KeyFrameId id) const;
  // Removes a keyframe from the graph; its pose stays known relative to its parent.
  void CullKeyFrame(KeyFrameId id);
  void SetWords(KeyFrameId id, std::shared_ptr<const BagOfWords> words);
  // Whether any keyframe with this id, culled or not, belongs to a map that still exists.
  bool Knows(KeyFrameId id) const;
  MapId MapOf(KeyFrameId id) const;

  // --- Points.
  // A new point that `feature` of `first_keyframe` shows; colour, descriptor and static weight come
  // from there.
  MapPointId AddPoint(const Eigen::Vector3d& p_w, KeyFrameId first_keyframe, int feature);
  const MapPoint* FindPoint(MapPointId id) const;
  std::vector<MapPointId> PointIds(MapId map) const;
  int NumPoints(MapId map) const;
  // The points that any of these keyframes shows, ascending, each once; keyframes that are gone are
  // passed over.
  std::vector<MapPointId> PointsSeenBy(std::span<const KeyFrameId> keyframes) const;
  void SetPosition(MapPointId id, const Eigen::Vector3d& p_w);
  // Moves a point together with those who see it: p_new = motion * p_old.
  void MovePoint(MapPointId id, const Rigid3d& motion);
  // One more image says how probable it is that the point stands still: its log-odds follow, by a
  // tenth of the difference per image, within probabilities of 0.02 to 0.98. So a single wrong
  // image does little, and about a dozen that agree decide. A point that nothing ever spoke against
  // keeps 1.
  void ObserveStaticProbability(MapPointId id, float probability);
  // Connects a point and a feature; either may be taken already, then nothing happens and it
  // returns false.
  bool AddObservation(MapPointId id, KeyFrameId keyframe, int feature);
  // Disconnects them; a point with fewer than 2 observations left disappears.
  void RemoveObservation(MapPointId id, KeyFrameId keyframe);
  void RemovePoint(MapPointId id);
  // Gives the observations of `old_id` to `new_id`; whoever holds `old_id` finds the other by
  // Resolve().
  void ReplacePoint(MapPointId old_id, MapPointId new_id);
  // The id under which the point lives today; invalid when it is gone.
  MapPointId Resolve(MapPointId id) const;
  void CountVisible(MapPointId id, int times = 1);
  void CountFound(MapPointId id, int times = 1);
  // Recomputes the representative descriptor, the viewing direction and the distance range from the
  // observations.
  void UpdateAppearance(MapPointId id);
  void UpdateNormalAndRange(MapPointId id);

  // --- Graphs.
  const CovisibilityGraph& covisibility() const { return covisibility_; }
  const SpanningTree& tree() const { return tree_; }
  // Recounts the shared points of a keyframe; the first time it also gets its place in the spanning
  // tree: below the keyframe it shares most points with, or, sharing none, below the one before it.
  void UpdateConnections(KeyFrameId id);
  void AddLoopEdge(KeyFrameId a, KeyFrameId b) { tree_.AddLoopEdge(a, b); }
  void SetParent(KeyFrameId id, KeyFrameId parent) { tree_.SetParent(id, parent); }
  void MakeRoot(KeyFrameId id) { tree_.MakeRoot(id); }

 private:
  // What remains of a keyframe that was culled.
  struct CulledKeyFrame {
    KeyFrameId attached_to;
    Rigid3d T_c_attached;
  };
  KeyFrame& MutableKeyFrame(KeyFrameId id);
  MapPoint& MutablePoint(MapPointId id);
  const CulledKeyFrame* FindCulled(KeyFrameId id) const;
  // The keyframe that joined the same map before this one; invalid for the first.
  KeyFrameId Predecessor(const KeyFrame& keyframe) const;
  // The keyframe, or the one that carries it after culling; nullptr when its map was dropped.
  const KeyFrame* Carrier(KeyFrameId id) const;

  std::shared_ptr<const Camera> camera_;
  ScaleLevels levels_;
  uint64_t version_ = 0;
  uint64_t weights_version_ = 0;
  uint64_t epoch_ = 0;
  MapId active_map_;
  int64_t num_maps_ = 0;
  // Indexed by id; null where the object is gone.
  std::vector<std::unique_ptr<KeyFrame>> keyframes_;
  std::vector<std::unique_ptr<CulledKeyFrame>> culled_;
  std::vector<std::unique_ptr<MapPoint>> points_;
  std::vector<MapPointId> replaced_by_;
  CovisibilityGraph covisibility_;
  SpanningTree tree_;
};

}  // namespace msf
