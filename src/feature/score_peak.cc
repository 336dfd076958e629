#include "feature/score_peak.h"

#include <array>
#include <cmath>

namespace msf {
namespace {

constexpr int kReach = 2;
constexpr int kWidth = 2 * kReach + 1;
constexpr float kMaxOffsetPx = 0.6f;

// One-dimensional kernels over -2 .. 2. The weight is separable, so the six terms 1, x, y, x^2 - m,
// y^2 - m, xy (m = the weighted mean of x^2) are orthogonal under it and each coefficient of the
// least-squares fit is one product of two of these.
struct FitKernels {
  std::array<float, kWidth> value{}, slope{}, bend{};
  FitKernels() {
    float sum = 0, sum2 = 0, sum_bend2 = 0;
    for (int i = 0; i < kWidth; ++i) {
      const float x = static_cast<float>(i - kReach);
      value[i] = std::exp(-x * x / 2);
      sum += value[i];
      sum2 += value[i] * x * x;
    }
    for (int i = 0; i < kWidth; ++i) {
      const float x = static_cast<float>(i - kReach);
      slope[i] = value[i] * x / sum2;
      bend[i] = value[i] * (x * x - sum2 / sum);
      sum_bend2 += bend[i] * (x * x - sum2 / sum);
    }
    for (int i = 0; i < kWidth; ++i) {
      value[i] /= sum;
      bend[i] *= 2 / sum_bend2;  // second derivative
    }
  }
};

}  // namespace

Eigen::Vector2f RefineScorePeak(const cv::Mat& scores, int x, int y) {
  static const FitKernels kernels;
  float gx = 0, gy = 0, hxx = 0, hyy = 0, hxy = 0;
  for (int row = 0; row < kWidth; ++row) {
    const uint8_t* score = scores.ptr<uint8_t>(y + row - kReach) + x - kReach;
    float value = 0, slope = 0, bend = 0;
    for (int column = 0; column < kWidth; ++column) {
      value += kernels.value[column] * score[column];
      slope += kernels.slope[column] * score[column];
      bend += kernels.bend[column] * score[column];
    }
    gx += kernels.value[row] * slope;
    gy += kernels.slope[row] * value;
    hxx += kernels.value[row] * bend;
    hyy += kernels.bend[row] * value;
    hxy += kernels.slope[row] * slope;
  }
  const float determinant = hxx * hyy - hxy * hxy;
  if (!(hxx < 0 && determinant > 1e-6f * hxx * hxx)) return Eigen::Vector2f::Zero();
  const Eigen::Vector2f offset(-(hyy * gx - hxy * gy) / determinant,
                               -(hxx * gy - hxy * gx) / determinant);
  return offset.cwiseMax(-kMaxOffsetPx).cwiseMin(kMaxOffsetPx);
}

}  // namespace msf
