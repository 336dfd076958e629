#include "dynamic/moving_clusters.h"

#include <algorithm>
#include <cmath>

namespace msf {
namespace {

constexpr float kSimilarDepth_m = 0.3f;
constexpr double kMostMove = 0.5;

bool SimilarDepth(float a_m, float b_m) {
  return a_m <= 0 || b_m <= 0 || std::abs(a_m - b_m) < kSimilarDepth_m;
}

std::vector<int> Collect(const std::vector<TestedPoint>& points, std::vector<int>& left,
                         double cluster_px) {
  std::vector<int> cluster = {left.back()};
  left.pop_back();
  for (size_t next = 0; next < cluster.size(); ++next) {
    const TestedPoint& point = points[cluster[next]];
    const auto near = std::stable_partition(left.begin(), left.end(), [&](int i) {
      return (points[i].image_px - point.image_px).norm() >= cluster_px ||
             !SimilarDepth(points[i].depth_m, point.depth_m);
    });
    cluster.insert(cluster.end(), near, left.end());
    left.erase(near, left.end());
  }
  return cluster;
}

bool MostMoveWithin(const std::vector<TestedPoint>& points, const std::vector<int>& cluster) {
  Eigen::Vector2f low = points[cluster[0]].image_px, high = low;
  std::vector<float> depths;
  for (const int i : cluster) {
    low = low.cwiseMin(points[i].image_px);
    high = high.cwiseMax(points[i].image_px);
    if (points[i].depth_m > 0) depths.push_back(points[i].depth_m);
  }
  float near_m = 0, far_m = 1e9f;
  if (!depths.empty()) {
    const auto [least, most] = std::minmax_element(depths.begin(), depths.end());
    near_m = *least - 0.1f;
    far_m = *most + 0.1f;
  }
  int tested = 0, moving = 0;
  for (const TestedPoint& point : points) {
    const bool inside = (point.image_px.array() >= low.array()).all() &&
                        (point.image_px.array() <= high.array()).all();
    if (!inside || (point.depth_m > 0 && (point.depth_m < near_m || point.depth_m > far_m)))
      continue;
    ++tested;
    moving += point.moves;
  }
  return moving >= kMostMove * tested;
}

}  // namespace

std::vector<std::vector<int>> FindMovingClusters(const std::vector<TestedPoint>& points,
                                                 const ObjectTrackOptions& options) {
  std::vector<int> left;
  for (size_t i = 0; i < points.size(); ++i) {
    if (points[i].moves) left.push_back(static_cast<int>(i));
  }
  std::vector<std::vector<int>> clusters;
  while (!left.empty()) {
    std::vector<int> cluster = Collect(points, left, options.cluster_px);
    if (static_cast<int>(cluster.size()) < options.min_cluster_points ||
        !MostMoveWithin(points, cluster))
      continue;
    std::sort(cluster.begin(), cluster.end());
    clusters.push_back(std::move(cluster));
  }
  return clusters;
}

}  // namespace msf
