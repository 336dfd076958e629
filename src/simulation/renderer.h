// Pictures of the simulated world as a perfect camera would take them: colour, depth and what
// stands where.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "geometry/rigid3d.h"
#include "sensor/camera.h"
#include "simulation/mesh.h"
#include "simulation/rasterizer.h"
#include "simulation/texture.h"

namespace msf {

// What never moves, and what everything is painted with.
struct Scene {
  std::vector<Texture> textures;
  std::vector<Light> lights;
  Mesh mesh;
};

// Something that moves, in world coordinates at one time. `label` > 0 marks its pixels in
// RenderedView::label.
struct PlacedMesh {
  Mesh mesh;
  int label = 0;
};

// All images have the size of the camera; depth is exact at pixel centres.
struct RenderedView {
  cv::Mat color;    // 32-bit float, 4 channels: blue, green, red, unused; 0..255 (may exceed 255)
  cv::Mat depth_m;  // 32-bit float, along the optical axis, 0 where there is nothing
  cv::Mat
      cosine;  // 32-bit float: cosine of the angle between the line of sight and the surface normal
  cv::Mat label;  // 8-bit, 0 = static
};

// Renders pinhole views; not for several threads at once.
class Renderer {
 public:
  // `camera`'s distortion is ignored. `scene` must outlive the renderer.
  Renderer(const Scene& scene, const Camera& camera);

  // Fills `view`, whose images are reused. `color_only` leaves all but the colour alone (sub-frames
  // of a motion blur).
  void Render(const Rigid3d& T_cw, const std::vector<PlacedMesh>& movers, bool color_only,
              RenderedView& view);

 private:
  void ShadeRow(int row, RenderedView& view) const;
  void MeasureRow(int row, RenderedView& view) const;
  Color4f Shade(const ProjectedTriangle& triangle, double x, double y) const;
  Color4f ShadeMixed(const int* upper, const int* lower, int column, int row) const;
  void ShadeRun(const ProjectedTriangle& triangle, int begin, int end, int row,
                Color4f* colors) const;

  const Scene& scene_;
  Camera camera_;
  Rasterizer rasterizer_;
};

}  // namespace msf
