#include "dynamic/block_rays.h"

namespace msf {

BlockRays::BlockRays(const Camera& camera) {
  constexpr int kCell = CoarseDepth::kCellSize, kBlock = kBlockCells * kCell;
  rows_ = (camera.height + kCell - 1) / kCell / kBlockCells;
  cols_ = (camera.width + kCell - 1) / kCell / kBlockCells;
  for (int r = 0; r < rows_; ++r) {
    for (int c = 0; c < cols_; ++c) {
      const Eigen::Vector2d px(c * kBlock + kCell / 2.0, r * kBlock + kCell / 2.0);
      rays_.emplace_back(camera.Unproject(camera.Undistort(px), 1).cast<float>());
    }
  }
}

}  // namespace msf
