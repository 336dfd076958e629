// The points of one image: positions, depths, descriptors and a grid that finds them by place.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "feature/descriptor.h"
#include "sensor/camera.h"

namespace msf {

// Parallel arrays, one entry per point. Immutable once built.
struct FrameFeatures {
  std::vector<Eigen::Vector2f> image_px;  // where the point is in the (distorted) image
  std::vector<Eigen::Vector2f> uv_px;     // undistorted: what Camera::Project predicts
  std::vector<float> depth_m;             // 0 = none
  std::vector<float> u_right_px;          // virtual stereo coordinate u - bf / depth; < 0 = none
  std::vector<float> angle_rad;           // orientation of the patch
  std::vector<uint8_t> level;             // pyramid level
  std::vector<float>
      static_weight;  // probability that the point belongs to the static world, [0, 1]
  std::vector<Descriptor> descriptors;

  int size() const { return static_cast<int>(uv_px.size()); }
  bool HasDepth(int i) const { return depth_m[i] > 0; }
  Eigen::Vector3d PointInCamera(int i, const Camera& camera) const {
    return camera.Unproject(uv_px[i].cast<double>(), depth_m[i]);
  }

  // Adds point `i` of `other` with a static probability of its own; the grid is to be built anew.
  void Append(const FrameFeatures& other, int i, float static_probability);
  // Sorts the points into the grid; to be called once the arrays are filled.
  void BuildGrid(const Camera& camera);
  // Appends the points whose undistorted position lies within radius_px (a square) and whose level
  // is in [min_level, max_level].
  void FindInArea(const Eigen::Vector2d& uv_px, double radius_px, int min_level, int max_level,
                  std::vector<int>& found) const;

 private:
  static constexpr int kGridColumns = 64;
  static constexpr int kGridRows = 48;
  Eigen::Vector2f grid_origin_px_ = Eigen::Vector2f::Zero();
  Eigen::Vector2f cells_per_px_ = Eigen::Vector2f::Zero();
  // What a search asks of a point, side by side in memory.
  struct CellPoint {
    Eigen::Vector2f uv_px;
    int32_t level;
    int32_t index;
  };
  std::vector<int32_t>
      cell_begin_;  // kGridColumns * kGridRows + 1 offsets into cell_points_, row by row
  std::vector<CellPoint> cell_points_;
};

}  // namespace msf
