#include "feature/rolling_shutter.h"

namespace msf {

FrameFeatures UndoRollingShutter(const FrameFeatures& features, const Camera& camera,
                                 const Vector6d& velocity) {
  FrameFeatures still = features;
  for (int i = 0; i < features.size(); ++i) {
    const double row_share = features.image_px[i].y() / (camera.height - 1) - 0.5;
    const Rigid3d T_middle_row = Rigid3d::Exp(velocity * (-row_share * camera.rolling_shutter_s));
    const bool has_depth = features.HasDepth(i);
    const Eigen::Vector3d p_row =
        camera.Unproject(features.uv_px[i].cast<double>(), has_depth ? features.depth_m[i] : 1.0);
    const Eigen::Vector3d p = has_depth ? T_middle_row * p_row : T_middle_row.rotation() * p_row;
    if (p.z() <= 0) continue;
    still.uv_px[i] = camera.Project(p).cast<float>();
    if (!has_depth) continue;
    still.depth_m[i] = static_cast<float>(p.z());
    still.u_right_px[i] = still.uv_px[i].x() - static_cast<float>(camera.bf / p.z());
  }
  still.BuildGrid(camera);
  return still;
}

}  // namespace msf
