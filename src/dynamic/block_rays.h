// Where the blocks of CoarseDepth look.
#pragma once

#include <vector>

#include "dynamic/coarse_depth.h"
#include "sensor/camera.h"

namespace msf {

// Directions (z = 1) through the places where the blocks (2 x 2 cells of CoarseDepth) take their
// depth.
class BlockRays {
 public:
  static constexpr int kBlockCells = 2;

  explicit BlockRays(const Camera& camera);
  int rows() const { return rows_; }
  int cols() const { return cols_; }
  const Eigen::Vector3f& At(int row, int col) const { return rays_[row * cols_ + col]; }
  // The point in the camera's frame; (0, 0, 0) without depth.
  Eigen::Vector3f Point(const CoarseDepth& depth, int row, int col) const {
    return depth.metres()(row * kBlockCells, col * kBlockCells) * At(row, col);
  }

 private:
  int rows_ = 0, cols_ = 0;
  std::vector<Eigen::Vector3f> rays_;
};

}  // namespace msf
