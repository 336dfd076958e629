#include "feature/smoothing.h"

#include <array>
#include <cstdint>
#include <vector>

namespace msf {
namespace {

// One side of a symmetric kernel, centre first; the whole adds up to 128.
template <int kReach>
using HalfKernel = std::array<uint16_t, kReach + 1>;

// sums[x] = 128 times the smoothed column at x: at most 128 * 255, so that two of them still fit 16
// bits.
template <int kReach>
void SmoothColumns(const uint8_t* row, ptrdiff_t stride, int width,
                   const HalfKernel<kReach>& kernel, uint16_t* sums) {
  for (int x = 0; x < width; ++x) {
    int sum = kernel[0] * row[x];
    for (int k = 1; k <= kReach; ++k)
      sum += kernel[k] * (row[x - k * stride] + row[x + k * stride]);
    sums[x] = static_cast<uint16_t>(sum);
  }
}

// (a * factor) / 2^16, the multiplication that vectors of 16-bit numbers have.
inline uint16_t MultiplyHigh(uint16_t a, uint16_t factor) {
  return static_cast<uint16_t>((static_cast<uint32_t>(a) * factor) >> 16);
}

template <int kReach>
void SmoothRow(const uint16_t* sums, int width, const HalfKernel<kReach>& kernel, uint8_t* to) {
  for (int x = kReach; x < width - kReach; ++x) {
    // A factor of 512 k makes the product of 16 bits the one with k / 128.
    uint16_t sum = MultiplyHigh(sums[x], static_cast<uint16_t>(512 * kernel[0]));
    for (int k = 1; k <= kReach; ++k) {
      const auto pair = static_cast<uint16_t>(sums[x - k] + sums[x + k]);
      sum = static_cast<uint16_t>(sum + MultiplyHigh(pair, static_cast<uint16_t>(512 * kernel[k])));
    }
    to[x] = static_cast<uint8_t>((sum + 64) >> 7);
  }
}

template <int kReach>
void Smooth(const cv::Mat& image, const HalfKernel<kReach>& kernel, cv::Mat& smoothed) {
  smoothed.create(image.size(), CV_8UC1);
  std::vector<uint16_t> sums(image.cols);
  for (int y = kReach; y < image.rows - kReach; ++y) {
    SmoothColumns<kReach>(image.ptr<uint8_t>(y), static_cast<ptrdiff_t>(image.step), image.cols,
                          kernel, sums.data());
    SmoothRow<kReach>(sums.data(), image.cols, kernel, smoothed.ptr<uint8_t>(y));
  }
}

}  // namespace

void SmoothForCorners(const cv::Mat& image, cv::Mat& smoothed) {
  Smooth<2>(image, {48, 32, 8}, smoothed);
}

void SmoothForDescriptors(const cv::Mat& image, cv::Mat& smoothed) {
  Smooth<3>(image, {28, 24, 17, 9}, smoothed);
}

}  // namespace msf
