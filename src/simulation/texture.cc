#include "simulation/texture.h"

#include <opencv2/imgproc.hpp>

#include "util/check.h"

namespace msf {

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

}  // namespace msf
