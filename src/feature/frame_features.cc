#include "feature/frame_features.h"

#include <algorithm>
#include <cmath>

namespace msf {
void FrameFeatures::Append(const FrameFeatures& other, int i, float static_probability) {
  image_px.push_back(other.image_px[i]);
  uv_px.push_back(other.uv_px[i]);
  depth_m.push_back(other.depth_m[i]);
  u_right_px.push_back(other.u_right_px[i]);
  angle_rad.push_back(other.angle_rad[i]);
  level.push_back(other.level[i]);
  static_weight.push_back(static_probability);
  descriptors.push_back(other.descriptors[i]);
}

void FrameFeatures::BuildGrid(const Camera& camera) {
  const Eigen::AlignedBox2d image = camera.IdealBounds();
  grid_origin_px_ = image.min().cast<float>();
  cells_per_px_ =
      Eigen::Vector2f(kGridColumns, kGridRows).cwiseQuotient(image.sizes().cast<float>());

  // Counting sort by cell keeps the points of a row of cells together in memory.
  std::vector<int32_t> cell_of(size());
  cell_begin_.assign(kGridColumns * kGridRows + 1, 0);
  for (int i = 0; i < size(); ++i) {
    const Eigen::Vector2f cell = (uv_px[i] - grid_origin_px_).cwiseProduct(cells_per_px_);
    const int column = std::clamp(static_cast<int>(cell.x()), 0, kGridColumns - 1);
    const int row = std::clamp(static_cast<int>(cell.y()), 0, kGridRows - 1);
    cell_of[i] = row * kGridColumns + column;
    ++cell_begin_[cell_of[i] + 1];
  }
  for (size_t cell = 1; cell < cell_begin_.size(); ++cell)
    cell_begin_[cell] += cell_begin_[cell - 1];
  cell_points_.resize(size());
  std::vector<int32_t> next(cell_begin_.begin(), cell_begin_.end() - 1);
  for (int i = 0; i < size(); ++i) cell_points_[next[cell_of[i]]++] = {uv_px[i], level[i], i};
}

void FrameFeatures::FindInArea(const Eigen::Vector2d& centre_px, double radius_px, int min_level,
                               int max_level, std::vector<int>& found) const {
  if (cell_points_.empty()) return;
  const Eigen::Vector2f centre = centre_px.cast<float>();
  const float radius = static_cast<float>(radius_px);
  const Eigen::Vector2f reach = Eigen::Vector2f::Constant(radius);
  const Eigen::Vector2f first = (centre - reach - grid_origin_px_).cwiseProduct(cells_per_px_);
  const Eigen::Vector2f last = (centre + reach - grid_origin_px_).cwiseProduct(cells_per_px_);
  if (!(first.x() < kGridColumns && first.y() < kGridRows && last.x() >= 0 && last.y() >= 0))
    return;
  const int first_column = std::max(0, static_cast<int>(first.x())),
            first_row = std::max(0, static_cast<int>(first.y()));
  const int last_column = std::min(kGridColumns - 1, static_cast<int>(last.x()));
  const int last_row = std::min(kGridRows - 1, static_cast<int>(last.y()));
  for (int row = first_row; row <= last_row; ++row) {
    const int32_t begin = cell_begin_[row * kGridColumns + first_column];
    const int32_t end = cell_begin_[row * kGridColumns + last_column + 1];
    for (int32_t k = begin; k < end; ++k) {
      const CellPoint& point = cell_points_[k];
      // One branch for all tests: which of them fails is hard to predict.
      const bool inside = (point.level >= min_level) & (point.level <= max_level) &
                          (std::abs(point.uv_px.x() - centre.x()) < radius) &
                          (std::abs(point.uv_px.y() - centre.y()) < radius);
      if (inside) found.push_back(point.index);
    }
  }
}

}  // namespace msf
