#include "simulation/rasterizer.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace msf {
namespace {

constexpr double kNear_m = 0.05;

// The plane over the picture of a value that is w * p_c on the triangle.
PicturePlane ToPicture(const Eigen::Vector3d& w, const Camera& camera) {
  const double a = w.x() / camera.fx, b = w.y() / camera.fy;
  return {a, b, w.z() - a * camera.cx - b * camera.cy};
}

}  // namespace

Rasterizer::Rasterizer(const Camera& camera)
    : camera_(camera),
      columns_(static_cast<size_t>(camera.width) * kSamples),
      rows_(static_cast<size_t>(camera.height) * kSamples),
      visible_(columns_ * rows_),
      inverse_depth_(columns_ * rows_),
      spans_(rows_) {}

void Rasterizer::Clear(const Rigid3d& T_cw) {
  T_cw_ = T_cw;
  triangles_.clear();
  std::fill(visible_.begin(), visible_.end(), -1);
  std::fill(inverse_depth_.begin(), inverse_depth_.end(), 0.f);
}

void Rasterizer::Draw(const Mesh& mesh, int label) {
  const Eigen::Matrix3d R_cw = T_cw_.RotationMatrix();
  points_c_.resize(mesh.vertices.size());
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    points_c_[i] = R_cw * mesh.vertices[i].position.cast<double>() + T_cw_.translation();
  }
  for (const Triangle& triangle : mesh.triangles) DrawTriangle(mesh, triangle, label);
}

void Rasterizer::DrawTriangle(const Mesh& mesh, const Triangle& triangle, int label) {
  Eigen::Matrix3d corners;
  for (int i = 0; i < 3; ++i) corners.row(i) = points_c_[triangle.vertices[i]];
  if (corners.col(2).maxCoeff() < kNear_m) return;
  const double volume = corners.row(0).dot(corners.row(1).cross(corners.row(2)));
  if (volume < 1e-12) return;  // seen from behind or edge-on

  polygon_.assign({corners.row(0), corners.row(1), corners.row(2)});
  ClipAtNearPlane();
  const auto [first_row, last_row] = FindSpans();
  if (first_row >= last_row) return;

  const Eigen::Matrix3d inverse = corners.inverse();
  const auto plane = [&](auto value) {
    const Eigen::Vector3d values(value(mesh.vertices[triangle.vertices[0]]),
                                 value(mesh.vertices[triangle.vertices[1]]),
                                 value(mesh.vertices[triangle.vertices[2]]));
    return ToPicture(inverse * values, camera_);
  };
  const Eigen::Vector3d w = inverse * Eigen::Vector3d::Ones();
  const PicturePlane inverse_depth = ToPicture(w, camera_);
  triangles_.push_back({inverse_depth, plane([](const Vertex& vertex) { return vertex.uv.x(); }),
                        plane([](const Vertex& vertex) { return vertex.uv.y(); }),
                        plane([](const Vertex& vertex) { return vertex.light; }), 1 / w.norm(),
                        triangle.texture, label});
  FillSpans(first_row, last_row, inverse_depth, static_cast<int>(triangles_.size()) - 1);
}

void Rasterizer::ClipAtNearPlane() {
  if (std::all_of(polygon_.begin(), polygon_.end(), [](const auto& p) { return p.z() >= kNear_m; }))
    return;
  clipped_.clear();
  for (size_t i = 0; i < polygon_.size(); ++i) {
    const Eigen::Vector3d& from = polygon_[i];
    const Eigen::Vector3d& to = polygon_[(i + 1) % polygon_.size()];
    if (from.z() >= kNear_m) clipped_.push_back(from);
    if ((from.z() >= kNear_m) == (to.z() >= kNear_m)) continue;
    clipped_.push_back(from + (kNear_m - from.z()) / (to.z() - from.z()) * (to - from));
  }
  std::swap(polygon_, clipped_);
}

std::pair<int, int> Rasterizer::FindSpans() {
  const double last = static_cast<double>(rows_);
  double top = last, bottom = 0;
  for (Eigen::Vector3d& corner : polygon_) {
    const Eigen::Vector2d uv_px = camera_.Project(corner);
    corner.head<2>() = uv_px * kSamples + Eigen::Vector2d(0.5, 0.5);  // inverse of SamplePosition
    top = std::min(top, corner.y());
    bottom = std::max(bottom, corner.y());
  }
  const int first_row = static_cast<int>(std::clamp(std::ceil(top), 0., last));
  const int last_row = static_cast<int>(std::clamp(std::ceil(bottom), 0., last));
  for (size_t i = 0; i < polygon_.size(); ++i) {
    const Eigen::Vector3d& from = polygon_[i];
    const Eigen::Vector3d& to = polygon_[(i + 1) % polygon_.size()];
    const bool right_side = to.y() > from.y();  // the corners run clockwise
    // Neighbours must find the very same border, so the edge is always walked from its upper end.
    const Eigen::Vector3d& upper = right_side ? from : to;
    const Eigen::Vector3d& lower = right_side ? to : from;
    const int begin = static_cast<int>(std::clamp(std::ceil(upper.y()), 0., last));
    const int end = static_cast<int>(std::clamp(std::ceil(lower.y()), 0., last));
    if (begin >= end) continue;
    const double slope = (lower.x() - upper.x()) / (lower.y() - upper.y());
    for (int row = begin; row < end; ++row) {
      const double x = upper.x() + (row - upper.y()) * slope;
      (right_side ? spans_[row].end : spans_[row].begin) = x;
    }
  }
  return {first_row, last_row};
}

void Rasterizer::FillSpans(int first_row, int last_row, const PicturePlane& inverse_depth,
                           int index) {
  const double columns = static_cast<double>(columns_);
  const float step = static_cast<float>(inverse_depth.a / kSamples);
  for (int row = first_row; row < last_row; ++row) {
    const int begin = static_cast<int>(std::clamp(std::ceil(spans_[row].begin), 0., columns));
    const int end = static_cast<int>(std::clamp(std::ceil(spans_[row].end), 0., columns));
    if (begin >= end) continue;
    const float start =
        static_cast<float>(inverse_depth.At(SamplePosition(begin), SamplePosition(row)));
    float* depths = &inverse_depth_[static_cast<size_t>(row) * columns_ + begin];
    int* visible = &visible_[static_cast<size_t>(row) * columns_ + begin];
    for (int i = 0; i < end - begin; ++i) {
      const float candidate = start + step * static_cast<float>(i);
      const bool nearer = candidate > depths[i];
      depths[i] = nearer ? candidate : depths[i];
      visible[i] = nearer ? index : visible[i];
    }
  }
}

}  // namespace msf
