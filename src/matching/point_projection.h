// Where a map point should appear in a view, and whether it can be seen there at all.
#pragma once

#include <optional>

#include "feature/scale_levels.h"
#include "geometry/rigid3d.h"
#include "map/map_point.h"
#include "sensor/camera.h"

namespace msf {

// A copy of what matching needs to know of a map point, valid without the map's lock.
struct PointSnapshot {
  PointSnapshot() = default;
  explicit PointSnapshot(const MapPoint& point)
      : id(point.id),
        p_w(point.p_w),
        normal(point.normal),
        min_distance_m(point.min_distance_m),
        max_distance_m(point.max_distance_m),
        descriptor(point.descriptor),
        static_weight(point.static_weight) {}

  MapPointId id;
  Eigen::Vector3d p_w, normal;
  double min_distance_m = 0, max_distance_m = 0;
  Descriptor descriptor{};
  float static_weight = 1;
};

struct ProjectedPoint {
  Eigen::Vector2d uv_px;
  double u_right_px = 0;   // virtual stereo coordinate
  double view_cosine = 0;  // between the ray and the point's mean viewing direction
  int level = 0;           // at which it should look as it did
};

// Projects points into one view: what does not depend on the point is computed once.
class ViewProjector {
 public:
  ViewProjector(const Rigid3d& T_cw, const Camera& camera, const ScaleLevels& levels,
                double min_view_cosine = 0.5);
  // Empty when the point lies behind the camera, outside the image, outside [0.8, 1.2] times its
  // distance range, or is seen from more than 60 degrees off its mean direction
  // (`min_view_cosine`).
  std::optional<ProjectedPoint> operator()(const PointSnapshot& point) const;

 private:
  const Camera& camera_;
  const ScaleLevels& levels_;
  Eigen::Matrix3d R_cw_;
  Eigen::Vector3d t_cw_;
  Eigen::Vector3d centre_w_;
  Eigen::AlignedBox2d image_;
  double min_view_cosine_;
};

}  // namespace msf
