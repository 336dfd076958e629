#include "feature/point_depth.h"

#include <algorithm>
#include <cmath>

namespace msf {

float PointDepth(const cv::Mat& depth, const Eigen::Vector2f& image_px, double depth_factor) {
  const int x = static_cast<int>(std::lround(image_px.x())),
            y = static_cast<int>(std::lround(image_px.y()));
  if (x < 0 || y < 0 || x >= depth.cols || y >= depth.rows) return 0;
  return static_cast<float>(depth.at<uint16_t>(y, x) / depth_factor);
}

float PointDepthFromElsewhere(const cv::Mat& depth, const Eigen::Vector2f& uv_px,
                              const Camera& camera, const Rigid3d& T_depth_color) {
  const Eigen::Vector3d ray = T_depth_color.rotation() * camera.Unproject(uv_px.cast<double>(), 1);
  if (ray.z() <= 0) return 0;
  const Eigen::Vector2d uv_depth_px = camera.Project(ray);
  const double depth_m =
      PointDepth(depth, camera.Distort(uv_depth_px).cast<float>(), camera.depth_factor);
  if (depth_m <= 0) return 0;
  const Eigen::Vector3d p_color = T_depth_color.Inverse() * camera.Unproject(uv_depth_px, depth_m);
  return static_cast<float>(std::max(0.0, p_color.z()));
}

}  // namespace msf
