// Learns the 256 comparisons of the descriptor (brief_pattern.cc) from a folder of photographs. Not
// part of the product: the vocabulary that we ship and every map on disk depend on the pattern, so
// it is learnt once.
//
//   learn_brief_pattern FOLDER_OF_JPEGS > src/feature/brief_pattern.cc
//
// After Rublee et al., ICCV 2011, section 4.3, with one thing more: a comparison should also give
// the same bit when the point is seen again a little turned, scaled, shifted and noisy.
//  1. Candidates: pairs of places, both coordinates normal with sigma kSigmaPx, inside the disc, at
//  least 2 px apart.
//  2. Each is evaluated on tens of thousands of corners, turned upright by their orientation,
//  twice: as seen, and as seen again.
//  3. Ordered by how often the bit flips plus how far its mean is from 1/2, a candidate is taken
//  when its correlation with
//     each one taken before is below a limit; the limit grows until 256 are found.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <random>
#include <vector>

#include "feature/brief_pattern.h"
#include "feature/orb_extractor.h"
#include "feature/smoothing.h"

namespace msf {
namespace {

constexpr double kSigmaPx = 10;  // the patch's whole disc, its middle a little denser
constexpr int kCandidates = 20000;
constexpr int kCornersPerImage = 40;
constexpr double kTurnRad = 0.07, kScale = 0.06, kShiftPx = 0.5,
                 kNoise = 2.0;  // "seen again", standard deviations

struct Candidate {
  BriefTest test;
  std::vector<uint64_t> bits;  // per corner
  double flips = 0;            // share of corners where the second view gives another bit
  double mean = 0;
  double Cost() const { return flips + std::abs(mean - 0.5); }
};

// Brightness of the places of the disc around one corner, index (y + 15) * 31 + x + 15.
using Patch = std::vector<uint8_t>;

Patch SamplePatch(const cv::Mat& smoothed, const Eigen::Vector2f& centre_px, double angle_rad,
                  double scale) {
  Patch patch(31 * 31, 0);
  const double c = scale * std::cos(angle_rad), s = scale * std::sin(angle_rad);
  for (int y = -kPatchRadiusPx; y <= kPatchRadiusPx; ++y) {
    for (int x = -kPatchRadiusPx; x <= kPatchRadiusPx; ++x) {
      if (x * x + y * y > kPatchRadiusPx * kPatchRadiusPx) continue;
      const int column = static_cast<int>(std::lround(centre_px.x() + c * x - s * y));
      const int row = static_cast<int>(std::lround(centre_px.y() + s * x + c * y));
      patch[(y + kPatchRadiusPx) * 31 + x + kPatchRadiusPx] = smoothed.at<uint8_t>(
          std::clamp(row, 3, smoothed.rows - 4), std::clamp(column, 3, smoothed.cols - 4));
    }
  }
  return patch;
}

struct Views {
  std::vector<Patch> first, again;
};

void AddImage(const cv::Mat& image, std::mt19937& random, Views& views) {
  RgbdFrame frame;
  frame.color = image;
  frame.depth = cv::Mat(image.size(), CV_16UC1, cv::Scalar(0));
  frame.camera = std::make_shared<const Camera>(
      Camera{.width = image.cols, .height = image.rows, .fx = 300, .fy = 300});
  OrbExtractor extractor({.num_features = kCornersPerImage, .num_levels = 1});
  const FrameFeatures features = extractor.Extract(frame);
  cv::Mat smoothed;
  SmoothForDescriptors(image, smoothed);
  std::normal_distribution<double> normal;
  for (int i = 0; i < features.size(); ++i) {
    views.first.push_back(SamplePatch(smoothed, features.image_px[i], features.angle_rad[i], 1));
    const Eigen::Vector2f shift(static_cast<float>(kShiftPx * normal(random)),
                                static_cast<float>(kShiftPx * normal(random)));
    Patch again =
        SamplePatch(smoothed, features.image_px[i] + shift,
                    features.angle_rad[i] + kTurnRad * normal(random), 1 + kScale * normal(random));
    for (uint8_t& value : again)
      value = cv::saturate_cast<uint8_t>(value + kNoise * normal(random));
    views.again.push_back(std::move(again));
  }
}

std::vector<Candidate> DrawCandidates(std::mt19937& random) {
  std::normal_distribution<double> normal(0, kSigmaPx);
  std::vector<Candidate> candidates;
  while (candidates.size() < kCandidates) {
    const auto draw = [&] {
      return static_cast<int8_t>(std::lround(std::clamp(normal(random), -99.0, 99.0)));
    };
    const BriefTest test{draw(), draw(), draw(), draw()};
    const auto inside = [](int x, int y) {
      return x * x + y * y <= kPatchRadiusPx * kPatchRadiusPx;
    };
    if (!inside(test.x0, test.y0) || !inside(test.x1, test.y1)) continue;
    if (std::hypot(test.x0 - test.x1, test.y0 - test.y1) < 2) continue;
    candidates.push_back({.test = test, .bits = {}});
  }
  return candidates;
}

void Evaluate(const Views& views, Candidate& candidate) {
  const BriefTest& test = candidate.test;
  const int a = (test.y0 + kPatchRadiusPx) * 31 + test.x0 + kPatchRadiusPx;
  const int b = (test.y1 + kPatchRadiusPx) * 31 + test.x1 + kPatchRadiusPx;
  const size_t count = views.first.size();
  candidate.bits.assign((count + 63) / 64, 0);
  size_t ones = 0, flips = 0;
  for (size_t i = 0; i < count; ++i) {
    const bool bit = views.first[i][a] < views.first[i][b];
    ones += bit;
    flips += bit != (views.again[i][a] < views.again[i][b]);
    candidate.bits[i / 64] |= static_cast<uint64_t>(bit) << (i % 64);
  }
  candidate.mean = static_cast<double>(ones) / count;
  candidate.flips = static_cast<double>(flips) / count;
}

// |correlation| of two bits whose means are near 1/2.
double Correlation(const Candidate& a, const Candidate& b, size_t count) {
  size_t different = 0;
  for (size_t i = 0; i < a.bits.size(); ++i) different += std::popcount(a.bits[i] ^ b.bits[i]);
  return std::abs(1 - 2.0 * different / count);
}

std::vector<const Candidate*> Select(const std::vector<Candidate>& ordered, size_t count,
                                     double limit) {
  std::vector<const Candidate*> taken;
  for (const Candidate& candidate : ordered) {
    const bool independent = std::all_of(taken.begin(), taken.end(), [&](const Candidate* other) {
      return Correlation(candidate, *other, count) < limit;
    });
    if (independent) taken.push_back(&candidate);
    if (taken.size() == 256) break;
  }
  return taken;
}

void Print(const std::vector<const Candidate*>& taken) {
  std::printf(
      "// Learnt by tools/learn_brief_pattern.cc, which describes the procedure.\n#include "
      "\"feature/brief_pattern.h\"\n\n");
  std::printf(
      "namespace msf {\n\n// clang-format off\nconst std::array<BriefTest, 256> kBriefPattern = "
      "{{\n");
  for (size_t i = 0; i < taken.size(); ++i) {
    const BriefTest& test = taken[i]->test;
    std::printf("%s{%d, %d, %d, %d},%s", i % 4 == 0 ? "    " : " ", test.x0, test.y0, test.x1,
                test.y1, i % 4 == 3 ? "\n" : "");
  }
  std::printf("}};\n// clang-format on\n\n}  // namespace msf\n");
}

int Main(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == ".jpg") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::mt19937 random(1);
  Views views;
  for (size_t i = 0; i < files.size(); i += 4) {
    const cv::Mat image = cv::imread(files[i].string(), cv::IMREAD_GRAYSCALE);
    if (!image.empty()) AddImage(image, random, views);
  }
  std::vector<Candidate> candidates = DrawCandidates(random);
  for (Candidate& candidate : candidates) Evaluate(views, candidate);
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.Cost() < b.Cost(); });
  double limit = 0.1;
  std::vector<const Candidate*> taken;
  while (taken.size() < 256 && limit < 1)
    taken = Select(candidates, views.first.size(), limit += 0.02);
  std::fprintf(stderr, "%zu corners, %zu comparisons, correlation below %.2f, flips %.3f .. %.3f\n",
               views.first.size(), taken.size(), limit, taken.front()->flips, taken.back()->flips);
  Print(taken);
  return taken.size() == 256 ? 0 : 1;
}

}  // namespace
}  // namespace msf

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: learn_brief_pattern FOLDER_OF_JPEGS\n");
    return 2;
  }
  return msf::Main(argv[1]);
}
