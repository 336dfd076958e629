#include "matching/rotation_consistency.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

namespace msf {
namespace {

constexpr int kNumBins = 30;
constexpr int kNumKept = 3;

int BinOf(float angle_rad) {
  const double turn = angle_rad / (2 * std::numbers::pi);
  return static_cast<int>(std::lround((turn - std::floor(turn)) * kNumBins)) % kNumBins;
}

}  // namespace

std::vector<bool> ConsistentRotations(const std::vector<float>& angle_changes_rad) {
  std::array<int, kNumBins> counts{};
  for (const float angle_rad : angle_changes_rad) ++counts[BinOf(angle_rad)];
  std::array<int, kNumBins> order{};
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return counts[a] > counts[b]; });
  std::array<bool, kNumBins> kept{};
  for (int rank = 0; rank < kNumKept; ++rank)
    kept[order[rank]] = 10 * counts[order[rank]] >= counts[order[0]];

  std::vector<bool> consistent;
  consistent.reserve(angle_changes_rad.size());
  for (const float angle_rad : angle_changes_rad) consistent.push_back(kept[BinOf(angle_rad)]);
  return consistent;
}

}  // namespace msf
