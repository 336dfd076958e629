#include "feature/fast_corners.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "feature/simd.h"

namespace msf {
namespace {

using Circle = std::array<ptrdiff_t, 16>;

// Address differences from the centre to the 16 pixels of the circle, in order around it.
Circle CircleOffsets(ptrdiff_t stride) {
  constexpr int kX[16] = {0, 1, 2, 3, 3, 3, 2, 1, 0, -1, -2, -3, -3, -3, -2, -1};
  Circle offsets;
  for (int i = 0; i < 16; ++i) offsets[i] = kX[(i + 4) % 16] * stride + kX[i];
  return offsets;
}

// max over the 16 arcs of 9 neighbouring values of the least value of the arc, with `Low` for least
// and `High` for max. Two arcs that differ in one pixel at each end share 8: max(min(m, a), min(m,
// b)) = min(m, max(a, b)).
template <typename V, V (*Low)(V, V), V (*High)(V, V)>
inline V BestArc(const V (&q)[16]) {
  V pair[8], four[8];
  for (int i = 0; i < 8; ++i) pair[i] = Low(q[2 * i + 1], q[(2 * i + 2) % 16]);
  for (int i = 0; i < 8; ++i) four[i] = Low(pair[i], pair[(i + 1) % 8]);
  V best{};
  for (int i = 0; i < 8; ++i) {
    const V eight = Low(four[i], four[(i + 2) % 8]);
    const V two_arcs = Low(eight, High(q[2 * i], q[(2 * i + 9) % 16]));
    best = i == 0 ? two_arcs : High(best, two_arcs);
  }
  return best;
}

template <typename V>
inline V Score(const uint8_t* centre, const Circle& circle) {
  V q[16];
  for (int i = 0; i < 16; ++i) q[i] = simd::Load<V>(centre + circle[i]);
  const V p = simd::Load<V>(centre);
  const V bright =
      BestArc<V, simd::Min<V>, simd::Max<V>>(q);  // every pixel of some arc is at least this bright
  const V dark = BestArc<V, simd::Max<V>, simd::Min<V>>(q);
  return static_cast<V>(simd::Max<V>(simd::Max<V>(bright, p) - p, p - simd::Min<V>(dark, p)));
}

// The score where it exceeds the threshold and all 8 neighbours, else 0.
template <typename V>
inline V Peak(const uint8_t* at, ptrdiff_t stride, uint8_t min_score) {
  V least = V{};
  least = static_cast<V>(least + min_score);
  for (const ptrdiff_t row : {-stride, ptrdiff_t{0}, stride}) {
    least =
        simd::Max<V>(least, simd::Max<V>(simd::Load<V>(at + row - 1), simd::Load<V>(at + row + 1)));
    if (row != 0) least = simd::Max<V>(least, simd::Load<V>(at + row));
  }
  const V score = simd::Load<V>(at);
  return score > least ? score : V{};
}

}  // namespace

void ComputeFastScores(const cv::Mat& image, const cv::Rect& area, cv::Mat& scores) {
  const Circle circle = CircleOffsets(static_cast<ptrdiff_t>(image.step));
  for (int y = area.y; y < area.y + area.height; ++y) {
    const uint8_t* from = image.ptr<uint8_t>(y);
    uint8_t* to = scores.ptr<uint8_t>(y);
    simd::ForEachBlock(area.x, area.x + area.width, [&](auto type, int x) {
      using V = decltype(type);
      simd::Store<V>(to + x, Score<V>(from + x, circle));
    });
  }
}

void FindScorePeaks(const cv::Mat& scores, const cv::Rect& area, int min_score,
                    std::vector<Corner>& corners) {
  const auto threshold = static_cast<uint8_t>(std::clamp(min_score, 0, 255));
  const auto stride = static_cast<ptrdiff_t>(scores.step);
  std::vector<uint8_t> peaks(area.width + 8, 0);  // one row, read eight at a time
  for (int y = area.y; y < area.y + area.height; ++y) {
    const uint8_t* from = scores.ptr<uint8_t>(y) + area.x;
    simd::ForEachBlock(0, area.width, [&](auto type, int x) {
      using V = decltype(type);
      simd::Store<V>(peaks.data() + x, Peak<V>(from + x, stride, threshold));
    });
    for (int block = 0; block < area.width; block += 8) {
      if (simd::Load<uint64_t>(peaks.data() + block) == 0) continue;
      for (int x = block; x < std::min(block + 8, area.width); ++x) {
        if (peaks[x] > 0)
          corners.push_back({static_cast<int16_t>(area.x + x), static_cast<int16_t>(y), peaks[x]});
      }
    }
  }
}

void KeepStrongPerCell(const cv::Rect& area, int cell_size_px, int strong_score,
                       std::vector<Corner>& corners) {
  const int columns = std::max(1, area.width / cell_size_px),
            rows = std::max(1, area.height / cell_size_px);
  std::vector<uint8_t> best(static_cast<size_t>(columns) * rows, 0);
  const auto cell = [&](const Corner& corner) -> uint8_t& {
    return best[(corner.y - area.y) * rows / area.height * columns +
                (corner.x - area.x) * columns / area.width];
  };
  for (const Corner& corner : corners) cell(corner) = std::max(cell(corner), corner.score);
  std::erase_if(corners, [&](const Corner& corner) {
    return corner.score <= strong_score && cell(corner) > strong_score;
  });
}

}  // namespace msf
