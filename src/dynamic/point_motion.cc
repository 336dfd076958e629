#include "dynamic/point_motion.h"

#include <algorithm>
#include <cmath>

namespace msf {
namespace {

// A point without depth lies somewhere on the line between these distances.
constexpr double kNearest_m = 0.4;
constexpr double kFarthest_m = 50;

double DepthSigma(double depth_m, const MotionTestOptions& options) {
  return options.depth_sigma_m + options.depth_sigma_per_m2 * depth_m * depth_m;
}

// Distance of `p` to the segment between `a` and `b`.
double DistanceToSegment(const Eigen::Vector2d& p, const Eigen::Vector2d& a,
                         const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0 ? std::clamp((p - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (p - a - t * along).norm();
}

// Whether depth near `image_px` agrees with `expected_m` anywhere: at an edge either side may be
// right.
enum class DepthVerdict { kNone, kAgrees, kDiffers };
DepthVerdict CompareDepth(const CoarseDepth& depth, const Eigen::Vector2f& image_px,
                          double expected_m, double tolerance_m) {
  const cv::Point cell = depth.CellOf(image_px.x(), image_px.y());
  int valid = 0;
  for (int r = std::max(0, cell.y - 1); r <= std::min(depth.rows() - 1, cell.y + 1); ++r) {
    for (int c = std::max(0, cell.x - 1); c <= std::min(depth.cols() - 1, cell.x + 1); ++c) {
      const float d = depth.metres()(r, c);
      if (d <= 0) continue;
      ++valid;
      if (std::abs(d - expected_m) <= tolerance_m) return DepthVerdict::kAgrees;
    }
  }
  constexpr int kEnough = 5;
  return valid >= kEnough ? DepthVerdict::kDiffers : DepthVerdict::kNone;
}

// How far a point landed from where a static one would have, in units of what noise explains.
struct Deviation {
  bool tested = false;
  double sideways = 0;
  bool depth_differs = false;
};

// The rows of an image are exposed one after the other: while the camera's motion changes, they
// disagree on it.
double UnsteadyFlow(const Camera& camera, const Vector6d& unsteadiness, double depth_m,
                    const MotionTestOptions& options) {
  return options.unsteady_share * camera.fx *
         (unsteadiness.tail<3>().norm() + unsteadiness.head<3>().norm() / depth_m);
}

Deviation DeviationWithoutDepth(const Camera& camera, const Eigen::Vector2d& uv_px,
                                const Eigen::Vector2d& landed_px, const Rigid3d& T_past_now,
                                double tolerance_px) {
  const Eigen::Vector3d near = T_past_now * camera.Unproject(uv_px, kNearest_m);
  const Eigen::Vector3d far = T_past_now * camera.Unproject(uv_px, kFarthest_m);
  if (near.z() <= 0 || far.z() <= 0) return {};
  return {true,
          DistanceToSegment(landed_px, camera.Project(near), camera.Project(far)) / tolerance_px,
          false};
}

Deviation DeviationWithDepth(const Camera& camera, const Eigen::Vector2d& uv_px, double depth_m,
                             const Eigen::Vector2d& landed_px,
                             const Eigen::Vector2f& landed_image_px, double flow_sigma_px,
                             const PastView& past, const MotionTestOptions& options) {
  const Eigen::Vector3d p_now = camera.Unproject(uv_px, depth_m);
  const Eigen::Vector3d p = past.T_past_now * p_now;
  if (p.z() <= 0) return {};
  // How far an error of depth moves the prediction: by the parallax, in proportion.
  const double parallax_px =
      (camera.Project(past.T_past_now.rotation() * p_now) - camera.Project(p)).norm();
  const double depth_sigma_px = parallax_px * DepthSigma(depth_m, options) / depth_m;
  const double tolerance_px = std::max(options.min_residual_px,
                                       options.sigmas * std::hypot(flow_sigma_px, depth_sigma_px)) +
                              options.flow_share * (camera.Project(p) - uv_px).norm() +
                              UnsteadyFlow(camera, past.unsteadiness, depth_m, options);
  const double depth_tolerance_m = 2 * options.sigmas * DepthSigma(p.z(), options);
  return {true, (landed_px - camera.Project(p)).norm() / tolerance_px,
          CompareDepth(past.depth, landed_image_px, p.z(), depth_tolerance_m) ==
              DepthVerdict::kDiffers};
}

// Some images agree worse with the motion of a rigid camera than others (fast turns under a rolling
// shutter, depth taken at another time than colour): most points beside the known objects still
// stand still, and what most of them deviate by is noise.
double NoiseFactor(const std::vector<Deviation>& deviations, const std::vector<uint8_t>& on_object,
                   double typical_share) {
  constexpr size_t kEnough = 10;
  std::vector<double> sideways;
  for (size_t k = 0; k < deviations.size(); ++k) {
    if (deviations[k].tested && !on_object[k]) sideways.push_back(deviations[k].sideways);
  }
  if (sideways.size() < kEnough) return 1;
  const auto middle = sideways.begin() + static_cast<std::ptrdiff_t>(sideways.size() / 2);
  std::nth_element(sideways.begin(), middle, sideways.end());
  return std::max(1.0, *middle / typical_share);
}

}  // namespace

std::vector<Eigen::Vector2f> PredictInPast(const Camera& camera, const FrameFeatures& features,
                                           std::span<const int> which, const Rigid3d& T_past_now) {
  std::vector<Eigen::Vector2f> predicted;
  predicted.reserve(which.size());
  for (const int i : which) {
    const double depth_m = features.HasDepth(i) ? features.depth_m[i] : kFarthest_m;
    const Eigen::Vector3d p =
        T_past_now * camera.Unproject(features.uv_px[i].cast<double>(), depth_m);
    predicted.push_back(p.z() > 0 ? camera.Distort(camera.Project(p)).cast<float>().eval()
                                  : features.image_px[i]);
  }
  return predicted;
}

std::vector<PointMotion> TestMotion(const Camera& camera, const ScaleLevels& levels,
                                    const FrameFeatures& features, const MotionTestPoints& points,
                                    const PastView& past, const MotionTestOptions& options) {
  std::vector<Deviation> deviations(points.which.size());
  for (size_t k = 0; k < deviations.size(); ++k) {
    const FlowPoint& flow = points.flow[k];
    if (!flow.found) continue;
    const int i = points.which[k];
    const Eigen::Vector2d landed_px = camera.Undistort(flow.image_px.cast<double>());
    const Eigen::Vector2d uv_px = features.uv_px[i].cast<double>();
    const double flow_sigma_px = options.flow_sigma_px * levels.scale(features.level[i]);
    if (features.HasDepth(i)) {
      deviations[k] = DeviationWithDepth(camera, uv_px, features.depth_m[i], landed_px,
                                         flow.image_px, flow_sigma_px, past, options);
    } else {
      const double tolerance_px =
          std::max(options.min_residual_px, options.sigmas * flow_sigma_px) +
          options.flow_share * (landed_px - uv_px).norm() +
          UnsteadyFlow(camera, past.unsteadiness, kFarthest_m, options);
      deviations[k] =
          DeviationWithoutDepth(camera, uv_px, landed_px, past.T_past_now, tolerance_px);
    }
  }
  const double noise = NoiseFactor(deviations, points.on_object, options.typical_share);
  std::vector<PointMotion> verdicts(deviations.size(), PointMotion::kUntested);
  for (size_t k = 0; k < deviations.size(); ++k) {
    if (!deviations[k].tested) continue;
    verdicts[k] = deviations[k].sideways > noise ? PointMotion::kMovesSideways
                  : deviations[k].depth_differs  ? PointMotion::kMovesInDepth
                                                 : PointMotion::kStatic;
  }
  return verdicts;
}

}  // namespace msf
