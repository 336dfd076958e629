// ORB points of an image (Rublee et al., ICCV 2011) with an even distribution over the picture.
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>

#include "feature/frame_features.h"
#include "feature/scale_levels.h"
#include "geometry/rigid3d.h"
#include "sensor/rgbd_frame.h"
#include "util/status.h"

namespace msf {

struct OrbOptions {
  int num_features = 1000;
  int num_levels = 8;
  double scale_factor = 1.2;
  int fast_threshold = 20;
  int min_fast_threshold = 7;
  int cell_size_px = 35;
  double even_share = 1.0;
  bool subpixel = true;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("num_features", num_features, "points per image");
    visit("num_levels", num_levels, "pyramid levels");
    visit("scale_factor", scale_factor, "shrink from level to level");
    visit("fast_threshold", fast_threshold, "FAST contrast, grey values");
    visit("min_fast_threshold", min_fast_threshold,
          "FAST contrast in cells where the first finds nothing");
    visit("cell_size_px", cell_size_px, "cell of the FAST search, px");
    visit("even_share", even_share,
          "share of the points that is spread evenly; the rest are the strongest left, 0..1");
    visit("subpixel", subpixel, "locate corners to fractions of a pixel");
  }
  Status Check() const;
};

// Single-threaded; keeps its buffers between images.
class OrbExtractor {
 public:
  explicit OrbExtractor(const OrbOptions& options);
  ~OrbExtractor();

  // The points of a frame with undistorted positions, depth, virtual stereo, weight 1, and the grid
  // built. `T_depth_color` takes coordinates of the camera when it took the colour image to those
  // when it took the depth image (see RgbdFrame::depth_delay_s).
  FrameFeatures Extract(const RgbdFrame& frame, const Rigid3d& T_depth_color = Rigid3d());
  // The same with `num_features` in place of the option (more where much of the image is masked).
  FrameFeatures Extract(const RgbdFrame& frame, int num_features,
                        const Rigid3d& T_depth_color = Rigid3d());

  const ScaleLevels& levels() const { return levels_; }

 private:
  struct Buffers;

  // Detects and describes the points of one pyramid level and appends them.
  void ExtractLevel(int level, int quota, FrameFeatures& features);

  OrbOptions options_;
  ScaleLevels levels_;
  std::unique_ptr<Buffers> buffers_;
};

// Number of points per level, proportional to (1 / factor)^level, adding up to `num_features`.
std::vector<int> LevelQuotas(const ScaleLevels& levels, int num_features);

}  // namespace msf
