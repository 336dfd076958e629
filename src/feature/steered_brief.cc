#include "feature/steered_brief.h"

#include <array>
#include <cmath>
#include <cstddef>

#include "feature/brief_pattern.h"

namespace msf {
namespace {

constexpr int kRadius = kPatchRadiusPx;
constexpr int kRowBytes = 32;  // the 31 columns of the disc and one that counts nothing

// For each row of the disc: 1 inside and 0 outside, so that sums over whole vectors count the disc
// only.
struct DiscMask {
  std::array<std::array<uint8_t, kRowBytes>, 2 * kRadius + 1> rows{};
  constexpr DiscMask() {
    for (int y = -kRadius; y <= kRadius; ++y) {
      for (int x = -kRadius; x <= kRadius; ++x) {
        // Half a pixel more than the radius makes the disc rounder.
        rows[y + kRadius][x + kRadius] = x * x + y * y < (kRadius + 0.5) * (kRadius + 0.5) ? 1 : 0;
      }
    }
  }
};
constexpr DiscMask kDisc;

// The pattern's places as separate arrays: a rotation is then one loop over vectors.
struct PatternArrays {
  std::array<float, 512> x{}, y{};  // first the 256 first places, then the 256 second places
  PatternArrays() {
    for (int i = 0; i < 256; ++i) {
      x[i] = kBriefPattern[i].x0, y[i] = kBriefPattern[i].y0;
      x[256 + i] = kBriefPattern[i].x1, y[256 + i] = kBriefPattern[i].y1;
    }
  }
};

}  // namespace

float PatchOrientation(const cv::Mat& image, int x, int y) {
  std::array<uint16_t, kRowBytes> column_sums{};
  int moment_y = 0;
  for (int row = -kRadius; row <= kRadius; ++row) {
    const uint8_t* pixels = image.ptr<uint8_t>(y + row) + x - kRadius;
    const auto& mask = kDisc.rows[row + kRadius];
    int row_sum = 0;
    for (int column = 0; column < 2 * kRadius + 1; ++column) {
      const int value = pixels[column] * mask[column];
      column_sums[column] = static_cast<uint16_t>(column_sums[column] + value);
      row_sum += value;
    }
    moment_y += row * row_sum;
  }
  int moment_x = 0;
  for (int column = 0; column < 2 * kRadius + 1; ++column)
    moment_x += (column - kRadius) * column_sums[column];
  return std::atan2(static_cast<float>(moment_y), static_cast<float>(moment_x));
}

Descriptor DescribePatch(const cv::Mat& smoothed, int x, int y, const Eigen::Vector2f& offset_px,
                         float angle_rad) {
  static const PatternArrays pattern;
  const float cosine = std::cos(angle_rad), sine = std::sin(angle_rad);
  const int stride = static_cast<int>(smoothed.step);
  std::array<int32_t, 512> offsets;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled below
  for (int i = 0; i < 512; ++i) {
    const float u = cosine * pattern.x[i] - sine * pattern.y[i] + offset_px.x();
    const float v = sine * pattern.x[i] + cosine * pattern.y[i] + offset_px.y();
    // Rounding to nearest by truncation of a positive number.
    const int column = static_cast<int>(u + 64.5f) - 64, row = static_cast<int>(v + 64.5f) - 64;
    offsets[i] = row * stride + column;
  }
  const uint8_t* centre = smoothed.ptr<uint8_t>(y) + x;
  std::array<uint8_t, 512> samples;  // NOLINT(cppcoreguidelines-pro-type-member-init)
  for (int i = 0; i < 512; ++i) samples[i] = centre[offsets[i]];
  Descriptor descriptor{};
  for (int word = 0; word < 4; ++word) {
    for (int bit = 0; bit < 64; ++bit) {
      const int i = 64 * word + bit;
      descriptor[word] |= static_cast<uint64_t>(samples[i] < samples[256 + i]) << bit;
    }
  }
  return descriptor;
}

}  // namespace msf
