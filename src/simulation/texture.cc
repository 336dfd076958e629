#include "simulation/texture.h"

#include <algorithm>
#include <cstring>
#include <opencv2/imgproc.hpp>

#include "util/check.h"

namespace msf {
namespace {

// Four bytes to four floats; written as shifts because compilers turn a conversion of byte vectors
// into scalar code.
Color4f Unpack(uint32_t texel) {
  using Int4 = int32_t __attribute__((vector_size(16)));
  using Word4 = uint32_t __attribute__((vector_size(16)));
  const Word4 bytes = (Word4{texel, texel, texel, texel} >> Word4{0, 8, 16, 24}) & 0xFF;
  return __builtin_convertvector(reinterpret_cast<const Int4&>(bytes), Color4f);
}

}  // namespace

Texture::Texture(const cv::Mat& bgr) {
  MSF_CHECK(bgr.type() == CV_8UC3 && bgr.cols >= 2 && bgr.rows >= 2, "textures are 8-bit BGR");
  cv::Mat texels;
  cv::cvtColor(bgr, texels, cv::COLOR_BGR2BGRA);
  while (true) {
    Level level{texels.cols, texels.rows, std::vector<uint32_t>(texels.total())};
    std::memcpy(level.texels.data(), texels.data, texels.total() * sizeof(uint32_t));
    levels_.push_back(std::move(level));
    if (std::min(texels.cols, texels.rows) < 4) break;
    cv::Mat half;
    cv::resize(texels, half, {(texels.cols + 1) / 2, (texels.rows + 1) / 2}, 0, 0, cv::INTER_AREA);
    texels = half;
  }
}

Color4f Texture::Level::Bilinear(float u, float v) const {
  const float x =
      std::clamp(u * static_cast<float>(width) - 0.5f, 0.f, static_cast<float>(width) - 1.001f);
  const float y =
      std::clamp(v * static_cast<float>(height) - 0.5f, 0.f, static_cast<float>(height) - 1.001f);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
  const uint32_t* top = texels.data() + static_cast<ptrdiff_t>(y0) * width + x0;
  const uint32_t* bottom = top + width;
  const Color4f c00 = Unpack(top[0]), c10 = Unpack(bottom[0]);
  const Color4f upper = c00 + (Unpack(top[1]) - c00) * fx;
  const Color4f lower = c10 + (Unpack(bottom[1]) - c10) * fx;
  return upper + (lower - upper) * fy;
}

Color4f Texture::Sample(float u, float v, float lod) const {
  const float finest = std::clamp(lod, 0.f, static_cast<float>(levels_.size() - 1));
  const size_t level = static_cast<size_t>(finest);
  const float blend = finest - static_cast<float>(level);
  const Color4f fine = levels_[level].Bilinear(u, v);
  if (blend < 0.02f || level + 1 >= levels_.size()) return fine;
  return fine + (levels_[level + 1].Bilinear(u, v) - fine) * blend;
}

}  // namespace msf
