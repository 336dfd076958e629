// A picture on a surface, with its mip pyramid, so that it looks the same (band-limited) from every
// distance.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

namespace msf {

// Four floats that the compiler keeps in one vector register: blue, green, red, unused; 0..255.
using Color4f = float __attribute__((vector_size(16)));

class Texture {
 public:
  // `bgr`: 8-bit, 3 channels, at least 2x2.
  explicit Texture(const cv::Mat& bgr);

  int width() const { return levels_.front().width; }
  int height() const { return levels_.front().height; }

  // Trilinear lookup. (u, v) in [0, 1] from the top left to the bottom right border, clamped
  // outside; `lod` = log2 of the footprint of a pixel in texels of the finest level.
  Color4f Sample(float u, float v, float lod) const;

 private:
  struct Level {
    int width;
    int height;
    std::vector<uint32_t> texels;  // four bytes each, row by row
    Color4f Bilinear(float u, float v) const;
  };
  std::vector<Level> levels_;
};

}  // namespace msf
