#include "loop_closing/map_correction.h"

namespace msf {
namespace {

// The motion of `id`: its own, or that of the nearest ancestor that has one.
Rigid3d InheritedMotion(const Map& map, const MapCorrection& correction, KeyFrameId id) {
  while (id.valid()) {
    const auto found = correction.motion.find(id);
    if (found != correction.motion.end()) return found->second;
    id = map.tree().Parent(id);
  }
  return Rigid3d();
}

}  // namespace

bool ApplyCorrection(const MapCorrection& correction, Map& map) {
  if (correction.epoch != map.epoch()) return false;
  std::map<KeyFrameId, Rigid3d> motion;
  for (const KeyFrameId id : map.KeyFrameIds(correction.map_id)) {
    motion[id] = InheritedMotion(map, correction, id);
  }
  for (const auto& [id, T_new_old] : motion) {
    map.SetPose(id, map.FindKeyFrame(id)->T_cw * T_new_old.Inverse());
  }
  std::map<MapPointId, Eigen::Vector3d> solved;
  for (const MapCorrection::Point& point : correction.points) {
    const MapPoint* present = map.FindPoint(point.id);
    if (present && present->p_w == point.before_w) solved.emplace(point.id, point.after_w);
  }
  for (const MapPointId id : map.PointIds(correction.map_id)) {
    const auto found = solved.find(id);
    if (found == solved.end()) {
      map.MovePoint(id, motion.at(map.FindPoint(id)->reference));
    } else {
      map.SetPosition(id, found->second);
      map.UpdateNormalAndRange(id);
    }
  }
  map.StartNewEpoch();
  return true;
}

}  // namespace msf
