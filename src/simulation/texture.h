// A picture on a surface, with its mip pyramid, so that it looks the same (band-limited) from every
// distance.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
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
  Color4f Sample(float u, float v, float lod) const {
    const float finest = std::clamp(lod, 0.f, static_cast<float>(levels_.size() - 1));
    const size_t level = static_cast<size_t>(finest);
    // Near a whole level one lookup is as good as two.
    const float blend = (finest - static_cast<float>(level) - 0.15f) / 0.7f;
    if (blend <= 0) return levels_[level].Bilinear(u, v);
    const size_t coarser = std::min(level + 1, levels_.size() - 1);
    if (blend >= 1) return levels_[coarser].Bilinear(u, v);
    const Color4f fine = levels_[level].Bilinear(u, v);
    return fine + (levels_[coarser].Bilinear(u, v) - fine) * blend;
  }

 private:
  struct Level {
    int width;
    int height;
    std::vector<uint32_t> texels;  // four bytes each, row by row

    Color4f Bilinear(float u, float v) const {
      const float columns = static_cast<float>(width), rows = static_cast<float>(height);
      const float x = std::clamp(u * columns - 0.5f, 0.f, columns - 1.001f);
      const float y = std::clamp(v * rows - 0.5f, 0.f, rows - 1.001f);
      const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
      const uint32_t* upper = texels.data() + static_cast<ptrdiff_t>(y0) * width + x0;
      const Pair top = Unpack(upper), bottom = Unpack(upper + width);
      const Pair columns_mixed = top + (bottom - top) * (y - static_cast<float>(y0));
      Color4f left, right;
      std::memcpy(&left, &columns_mixed, sizeof(left));
      std::memcpy(&right, reinterpret_cast<const char*>(&columns_mixed) + sizeof(left),
                  sizeof(right));
      return left + (right - left) * (x - static_cast<float>(x0));
    }
  };

  // Two neighbouring texels.
  using Pair = float __attribute__((vector_size(32)));

  // Written as shifts because compilers turn a conversion of byte vectors into scalar code.
  static Pair Unpack(const uint32_t* texels) {
    using Words = uint32_t __attribute__((vector_size(32)));
    using Ints = int32_t __attribute__((vector_size(32)));
    const uint32_t a = texels[0], b = texels[1];
    const Words bytes = (Words{a, a, a, a, b, b, b, b} >> Words{0, 8, 16, 24, 0, 8, 16, 24}) & 0xFF;
    return __builtin_convertvector(reinterpret_cast<const Ints&>(bytes), Pair);
  }

  std::vector<Level> levels_;
};

}  // namespace msf
