// Which triangle does every sample of the picture see? Four samples per pixel, so that edges are
// smooth in the picture.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/rigid3d.h"
#include "sensor/camera.h"
#include "simulation/mesh.h"

namespace msf {

// A value that is linear over a triangle, divided by depth, is linear over the picture: value(x, y)
// = a x + b y + c with x, y in pixels (Blinn 1992, hyperbolic interpolation).
struct PicturePlane {
  double a, b, c;
  double At(double x, double y) const { return a * x + b * y + c; }
};

// A triangle that faces the camera.
struct ProjectedTriangle {
  PicturePlane inverse_depth;  // 1/z, 1/m
  PicturePlane u, v;           // texture coordinates / z
  PicturePlane light;          // brightness / z
  double distance_m;           // of the camera from the triangle's plane
  int texture;
  int label;
};

// Not for several threads at once.
class Rasterizer {
 public:
  static constexpr int kSamples = 2;  // per pixel and direction

  explicit Rasterizer(const Camera& camera);

  // Starts a picture from `T_cw`.
  void Clear(const Rigid3d& T_cw);
  // Draws a mesh; its pixels carry `label`.
  void Draw(const Mesh& mesh, int label);

  const std::vector<ProjectedTriangle>& triangles() const { return triangles_; }
  // Sample `row` (0 .. 2 * height - 1): the index of the visible triangle per sample, -1 for none;
  // and its 1/z.
  const int* TriangleRow(int row) const { return &visible_[static_cast<size_t>(row) * columns_]; }
  const float* InverseDepthRow(int row) const {
    return &inverse_depth_[static_cast<size_t>(row) * columns_];
  }
  // Where sample column or row `index` lies in pixels; pixel centres are whole numbers.
  static double SamplePosition(int index) { return (index - 0.5) / kSamples; }

 private:
  struct Span {
    double begin, end;  // sample columns
  };
  // A corner in camera coordinates.
  using Polygon = std::vector<Eigen::Vector3d>;

  void DrawTriangle(const Mesh& mesh, const Triangle& triangle, int label);
  void ClipAtNearPlane();
  // Fills spans_ for the sample rows of the polygon and returns the rows [first, last).
  std::pair<int, int> FindSpans();
  void FillSpans(int first_row, int last_row, const PicturePlane& inverse_depth, int index);

  Camera camera_;
  size_t columns_;
  size_t rows_;
  Rigid3d T_cw_;
  std::vector<Eigen::Vector3d> points_c_;
  std::vector<ProjectedTriangle> triangles_;
  std::vector<int> visible_;
  std::vector<float> inverse_depth_;
  std::vector<Span> spans_;
  Polygon polygon_, clipped_;
};

}  // namespace msf
