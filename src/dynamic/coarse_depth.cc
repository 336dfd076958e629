#include "dynamic/coarse_depth.h"

namespace msf {

CoarseDepth::CoarseDepth(const RgbdFrame& frame)
    : metres_((frame.depth.rows + kCellSize - 1) / kCellSize,
              (frame.depth.cols + kCellSize - 1) / kCellSize) {
  const auto factor = static_cast<float>(1 / frame.camera->depth_factor);
  for (int r = 0; r < metres_.rows; ++r) {
    const int y = std::min(r * kCellSize + kCellSize / 2, frame.depth.rows - 1);
    const uint16_t* row = frame.depth.ptr<uint16_t>(y);
    for (int c = 0; c < metres_.cols; ++c) {
      metres_(r, c) =
          factor *
          static_cast<float>(row[std::min(c * kCellSize + kCellSize / 2, frame.depth.cols - 1)]);
    }
  }
}

}  // namespace msf
