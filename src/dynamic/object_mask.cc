#include "dynamic/object_mask.h"

#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace msf {
namespace {

constexpr float kBinSize_m = 0.1f;
constexpr int kNumBins = 100;
constexpr float kSeedBand_m = 0.15f;

cv::Rect CellsOf(const CoarseDepth& depth, const ImageBox& box) {
  const cv::Point a = depth.CellOf(box.x0, box.y0), b = depth.CellOf(box.x1 - 1, box.y1 - 1);
  return {a.x, a.y, std::max(1, b.x - a.x + 1), std::max(1, b.y - a.y + 1)};
}

ImageBox Scaled(const ImageBox& box, float horizontal, float vertical) {
  const float cx = 0.5f * (box.x0 + box.x1), cy = 0.5f * (box.y0 + box.y1);
  const float w = 0.5f * horizontal * box.width(), h = 0.5f * vertical * box.height();
  return {cx - w, cy - h, cx + w, cy + h};
}

struct DepthHistogram {
  std::array<int, kNumBins> counts{};
  int valid = 0;
  int cells = 0;

  DepthHistogram(const CoarseDepth& depth, const cv::Rect& core) : cells(core.area()) {
    for (int r = core.y; r < core.br().y; ++r) {
      for (int c = core.x; c < core.br().x; ++c) {
        const float d = depth.metres()(r, c);
        if (d <= 0) continue;
        ++valid;
        ++counts[std::min(kNumBins - 1, static_cast<int>(d / kBinSize_m))];
      }
    }
  }
  // Cells in three neighbouring bins.
  int Around(int bin) const {
    int sum = 0;
    for (int b = std::max(0, bin - 1); b <= std::min(kNumBins - 1, bin + 1); ++b) sum += counts[b];
    return sum;
  }
};

// The depth that stands for the object: near where it was, else the nearest of the large clusters.
float TypicalDepth(const DepthHistogram& histogram, std::optional<float> expected_depth_m) {
  constexpr float kReach_m = 0.4f;
  int best = 0;
  for (int bin = 1; bin < kNumBins; ++bin) {
    if (histogram.Around(bin) > histogram.Around(best)) best = bin;
  }
  int chosen = best;
  for (int bin = best; bin >= 0; --bin) {
    if (histogram.Around(bin) * 10 >= histogram.Around(best) * 6) chosen = bin;
  }
  // Up to the top of the nearer cluster's hill.
  while (chosen < best && histogram.Around(chosen + 1) > histogram.Around(chosen)) ++chosen;
  if (expected_depth_m) {
    int expected = -1;
    for (int bin = 0; bin < kNumBins; ++bin) {
      const float centre = (static_cast<float>(bin) + 0.5f) * kBinSize_m;
      if (std::abs(centre - *expected_depth_m) > kReach_m) continue;
      if (expected < 0 || histogram.Around(bin) > histogram.Around(expected)) expected = bin;
    }
    if (expected >= 0 && histogram.Around(expected) * 8 >= histogram.valid) chosen = expected;
  }
  return (static_cast<float>(chosen) + 0.5f) * kBinSize_m;
}

// Flood from the seeds over cells whose depth changes little from cell to cell and stays in the
// band.
cv::Mat1b Flood(const CoarseDepth& depth, const BlockVerdicts& background,
                const std::vector<cv::Point>& seeds, const cv::Rect& limits, float depth_m,
                const ObjectMaskOptions& options) {
  cv::Mat1b mask(depth.rows(), depth.cols(), static_cast<uint8_t>(0));
  std::vector<cv::Point> open = seeds;
  for (const cv::Point& seed : seeds) mask(seed) = 255;
  while (!open.empty()) {
    const cv::Point cell = open.back();
    open.pop_back();
    const float d = depth.metres()(cell);
    const auto step = static_cast<float>(options.max_step_share * d + options.max_step_m);
    for (const cv::Point& side :
         {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1)}) {
      const cv::Point next = cell + side;
      if (!limits.contains(next) || mask(next) != 0 ||
          background.OfCell(next) == BlockVerdict::kConfirmed)
        continue;
      const float other = depth.metres()(next);
      if (other <= 0 || std::abs(other - d) > step ||
          std::abs(other - depth_m) > static_cast<float>(options.depth_band_m))
        continue;
      mask(next) = 255;
      open.push_back(next);
    }
  }
  return mask;
}

// Drops pieces much smaller than the largest.
void KeepLargePieces(cv::Mat1b& mask) {
  constexpr int kSmallestShare = 5;  // of the largest: one fifth
  cv::Mat1b part = mask(cv::boundingRect(mask));
  if (part.empty()) return;
  cv::Mat labels, stats, centres;
  const int count = cv::connectedComponentsWithStats(part, labels, stats, centres, 8, CV_32S);
  int largest = 0;
  for (int i = 1; i < count; ++i) largest = std::max(largest, stats.at<int>(i, cv::CC_STAT_AREA));
  for (int r = 0; r < part.rows; ++r) {
    for (int c = 0; c < part.cols; ++c) {
      if (part(r, c) != 0 &&
          stats.at<int>(labels.at<int>(r, c), cv::CC_STAT_AREA) * kSmallestShare < largest)
        part(r, c) = 0;
    }
  }
}

// Grows by whole cells, first everywhere, then over cells without depth: the band beside an object
// that the sensor's projector does not reach shows the object's edge in the colour image.
void Grow(cv::Mat1b& mask, const CoarseDepth& depth, int without_depth_px,
          const ObjectMaskOptions& options) {
  const cv::Mat cross = cv::getStructuringElement(cv::MORPH_CROSS, {3, 3});
  cv::morphologyEx(mask, mask, cv::MORPH_CLOSE, cross);
  const int everywhere = (options.grow_px + CoarseDepth::kCellSize - 1) / CoarseDepth::kCellSize;
  if (everywhere > 0) cv::dilate(mask, mask, cross, {-1, -1}, everywhere);
  const cv::Mat1b without_depth = depth.metres() <= 0;
  for (int px = 0; px < without_depth_px; px += CoarseDepth::kCellSize) {
    cv::Mat1b wider;
    cv::dilate(mask, wider, cross);
    mask |= wider & without_depth;
  }
}

// Who is nearer than the sensor can measure has no depth, and what has depth in the box may all be
// behind.
void AddCellsWithoutDepth(const CoarseDepth& depth, const cv::Rect& box, cv::Mat1b& mask) {
  const cv::Mat1b without_depth = depth.metres()(box) <= 0;
  mask(box) |= without_depth;
}

ObjectMask Finished(cv::Mat1b cells, float depth_m) {
  ObjectMask mask;
  mask.cells = std::move(cells);
  mask.depth_m = depth_m;
  mask.area = cv::countNonZero(mask.cells);
  const cv::Rect around = cv::boundingRect(mask.cells);
  constexpr auto kSize = static_cast<float>(CoarseDepth::kCellSize);
  mask.box = {static_cast<float>(around.x) * kSize, static_cast<float>(around.y) * kSize,
              static_cast<float>(around.br().x) * kSize, static_cast<float>(around.br().y) * kSize};
  return mask;
}

}  // namespace

ObjectMask WholeBox(const CoarseDepth& depth, const ImageBox& box) {
  cv::Mat1b cells(depth.rows(), depth.cols(), static_cast<uint8_t>(0));
  cells(CellsOf(depth, box)) = 255;
  return Finished(std::move(cells), 0);
}

ObjectMask Union(const ObjectMask& a, const ObjectMask& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return Finished(a.cells | b.cells, a.area >= b.area ? a.depth_m : b.depth_m);
}

ObjectMask MaskInBox(const CoarseDepth& depth, const BlockVerdicts& background, const ImageBox& box,
                     bool trusted, std::optional<float> expected_depth_m,
                     const ObjectMaskOptions& options) {
  const cv::Rect core = CellsOf(depth, Scaled(box, 0.6f, 0.8f));
  const DepthHistogram histogram(depth, core);
  if (histogram.valid < options.min_depth_share * histogram.cells) return WholeBox(depth, box);
  const float depth_m = TypicalDepth(histogram, expected_depth_m);
  std::vector<cv::Point> seeds, confirmed;
  for (int r = core.y; r < core.br().y; ++r) {
    for (int c = core.x; c < core.br().x; ++c) {
      const float d = depth.metres()(r, c);
      if (d <= 0 || std::abs(d - depth_m) >= kSeedBand_m) continue;
      const bool is_background = background.OfCell({c, r}) == BlockVerdict::kConfirmed;
      (is_background ? confirmed : seeds).emplace_back(c, r);
    }
  }
  constexpr size_t kAlmostAll = 5;  // to one
  const auto margin = static_cast<float>(1 + 2 * options.box_margin);
  cv::Mat1b cells;
  if (trusted && confirmed.size() > kAlmostAll * seeds.size()) {
    cells = Flood(depth, {}, confirmed, CellsOf(depth, box), depth_m, options);
  } else {
    cells = Flood(depth, background, seeds, CellsOf(depth, Scaled(box, margin, margin)), depth_m,
                  options);
  }
  KeepLargePieces(cells);
  int without_depth_px = options.grow_without_depth_px;
  if (histogram.valid < options.near_depth_share * histogram.cells) {
    AddCellsWithoutDepth(depth, CellsOf(depth, box), cells);
    without_depth_px *= 2;  // the box ends less exactly where the object does than depth would
  }
  Grow(cells, depth, without_depth_px, options);
  return Finished(std::move(cells), depth_m);
}

ObjectMask MaskAroundPoints(const CoarseDepth& depth, const BlockVerdicts& background,
                            const std::vector<Eigen::Vector2f>& points_px, float depth_m,
                            const ImageBox& box, const ObjectMaskOptions& options) {
  std::vector<cv::Point> seeds;
  for (const Eigen::Vector2f& point : points_px) {
    const cv::Point cell = depth.CellOf(point.x(), point.y());
    const float d = depth.metres()(cell);
    const bool similar = d > 0 && std::abs(d - depth_m) < static_cast<float>(options.depth_band_m);
    if (similar && background.OfCell(cell) != BlockVerdict::kConfirmed) seeds.push_back(cell);
  }
  cv::Mat1b cells = Flood(depth, background, seeds, CellsOf(depth, box), depth_m, options);
  Grow(cells, depth, options.grow_without_depth_px, options);
  return Finished(std::move(cells), depth_m);
}

}  // namespace msf
