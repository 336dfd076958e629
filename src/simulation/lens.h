// The distortion of a camera's lens, put on views that were rendered without it.
#pragma once

#include <opencv2/core/mat.hpp>

#include "sensor/camera.h"
#include "simulation/renderer.h"

namespace msf {

class Lens {
 public:
  explicit Lens(const Camera& camera);

  // The pinhole camera to render with: it sees all that the distorted picture shows.
  const Camera& ideal() const { return ideal_; }
  // What `ideal` looks like through the lens. Depth is exact on planes: its inverse is
  // interpolated, except across edges.
  void Apply(const RenderedView& ideal, RenderedView& view) const;

 private:
  void ApplyToSurfaces(const RenderedView& ideal, int y, RenderedView& view) const;

  Camera ideal_;
  cv::Mat source_;  // 2 x 32-bit float: pixel of the ideal picture for each pixel of the distorted
                    // one; empty without distortion
};

}  // namespace msf
