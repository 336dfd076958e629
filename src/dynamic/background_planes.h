// Large flat surfaces - walls, floors, tables - that go on outside of objects' boxes: what lies on
// one is not the object, however close the object comes to it.
#pragma once

#include <vector>

#include "dynamic/coarse_depth.h"
#include "dynamic/dynamic_options.h"
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

// Blocks on planes: 255, others 0. `in_box`: 255 for blocks inside objects' boxes, which do not
// make planes; those on a plane must hang together with a part of it outside. Consensus over
// samples decided by `seed`.
cv::Mat1b FindPlaneBlocks(const CoarseDepth& depth, const BlockRays& rays, const cv::Mat1b& in_box,
                          const PlaneOptions& options, uint64_t seed);

}  // namespace msf
