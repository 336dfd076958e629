// From perfect depth to what a structured-light camera of the Kinect kind delivers.
#pragma once

#include <opencv2/core/mat.hpp>

#include "sensor/camera.h"
#include "simulation/random.h"
#include "simulation/renderer.h"
#include "util/status.h"

namespace msf {

struct DepthSensorOptions {
  bool perfect = false;
  double noise_per_m = 0.0015;
  double disparity_steps = 8;
  double distortion_px = 0;
  double nearest_m = 0.45;
  double farthest_m = 5.0;
  double edge_dropout = 0.35;
  bool shadow = true;
  double grazing_deg = 78;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("perfect", perfect, "true: exact depth, rounded to the image's unit only");
    visit("noise_per_m", noise_per_m, "axial noise: standard deviation = noise_per_m * z^2, m");
    visit("disparity_steps", disparity_steps, "disparity is measured in steps of 1 / this, px");
    visit("distortion_px", distortion_px,
          "largest systematic error of disparity, px: a smooth field, fixed for a camera");
    visit("nearest_m", nearest_m, "nothing is measured nearer, m");
    visit("farthest_m", farthest_m, "nothing is measured farther, m");
    visit("edge_dropout", edge_dropout, "share of pixels at depth edges without depth");
    visit("shadow", shadow, "no depth where the projector is hidden by something nearer");
    visit("grazing_deg", grazing_deg,
          "surfaces seen at more than this angle from their normal fade out");
  }
  Status Check() const;
};

// After Khoshelham and Elberink 2012 (random error grows with z^2, disparity is quantised), Nguyen,
// Izadi and Lovell 2012 (lateral noise of about a pixel at edges, loss at grazing angles) and
// Teichman, Miller and Thrun 2013 (every camera has a smooth distortion of depth of its own, some
// per cent at room distance).
class DepthSensor {
 public:
  DepthSensor(const DepthSensorOptions& options, const Camera& camera, Random random);

  // 16-bit depth image of a rendered view; `random` makes this frame's noise.
  cv::Mat Measure(const RenderedView& view, Random random) const;

 private:
  // What is known about the pixels of one row.
  struct Row {
    int y;
    const uint8_t* hidden;
    const uint8_t* edge;
    const float* cosine;
    const float* noise;
    int noise_shift;
  };
  void FindShadow(const float* disparity, uint8_t* hidden) const;
  void MakeDistortion(Random random);
  void MarkEdges(const cv::Mat& disparity, int y, uint8_t* edge) const;

  void MeasureRow(const cv::Mat& disparity, const Row& row, Random& random, uint16_t* depth) const;

  DepthSensorOptions options_;
  Camera camera_;
  cv::Mat distortion_px_;  // 32-bit float: added to the disparity
  cv::Mat noise_;          // standard normal, neighbours alike: matching windows overlap
};

}  // namespace msf
