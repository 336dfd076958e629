#include "estimation/ransac.h"

#include <gtest/gtest.h>

#include <set>

namespace msf {
namespace {

// y = slope * x + offset through noisy points of which 60 % lie anywhere.
struct LineData {
  std::vector<std::pair<double, double>> points;

  LineData() {
    std::mt19937_64 random(4);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int i = 0; i < 100; ++i) {
      const double x = 10 * uniform(random);
      points.emplace_back(x, i % 5 < 2 ? 2 * x + 1 + 0.02 * uniform(random) : 20 * uniform(random));
    }
  }
};

using Line = std::pair<double, double>;

std::optional<Consensus<Line>> FindLine(const LineData& data, const RansacOptions& options,
                                        int* samples = nullptr) {
  const auto fit = [&](const std::array<int, 2>& sample, std::vector<Line>& lines) {
    if (samples != nullptr) ++*samples;
    const auto [x0, y0] = data.points[sample[0]];
    const auto [x1, y1] = data.points[sample[1]];
    const double slope = (y1 - y0) / (x1 - x0);
    lines.emplace_back(slope, y0 - slope * x0);
  };
  const auto is_inlier = [&](const Line& line, int i) {
    return std::abs(line.first * data.points[i].first + line.second - data.points[i].second) < 0.1;
  };
  return Ransac<Line, 2>(static_cast<int>(data.points.size()), options, fit, is_inlier);
}

TEST(Ransac, FindsTheLineAmongOutliers) {
  const auto consensus = FindLine({}, {});
  ASSERT_TRUE(consensus);
  EXPECT_NEAR(consensus->model.first, 2, 0.05);
  EXPECT_NEAR(consensus->model.second, 1, 0.1);
  EXPECT_GE(consensus->num_inliers, 40);
  EXPECT_EQ(consensus->num_inliers,
            std::count(consensus->inlier.begin(), consensus->inlier.end(), 1));
}

TEST(Ransac, StopsWhenConfident) {
  int samples = 0;
  ASSERT_TRUE(FindLine({}, {.max_iterations = 100000}, &samples));
  EXPECT_LT(samples, 100);
}

TEST(Ransac, NothingWithoutConsensus) {
  EXPECT_FALSE(FindLine({}, {.min_inliers = 70}));
  EXPECT_FALSE(FindLine({}, {.min_inliers = 101}));
}

TEST(Ransac, RepeatsForEqualSeeds) {
  EXPECT_EQ(FindLine({}, {.seed = 3})->model, FindLine({}, {.seed = 3})->model);
}

TEST(Ransac, IterationsFollowTheFormula) {
  EXPECT_EQ(RansacIterations(0.5, 3, 0.99, 300), 35);  // log(0.01) / log(1 - 0.125) = 34.5
  EXPECT_EQ(RansacIterations(1, 3, 0.99, 300), 1);
  EXPECT_EQ(RansacIterations(0.01, 3, 0.99, 300), 300);
  EXPECT_EQ(RansacIterations(0, 3, 0.99, 300), 300);
}

TEST(Ransac, SamplesHoldDifferentIndices) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 200; ++i) {
    const std::array<int, 3> sample = DrawSample<3>(4, random);
    EXPECT_EQ(std::set<int>(sample.begin(), sample.end()).size(), 3u);
    EXPECT_LT(*std::max_element(sample.begin(), sample.end()), 4);
  }
}

TEST(Ransac, OptionsAreChecked) {
  EXPECT_TRUE(RansacOptions{}.Check().ok());
  EXPECT_FALSE(RansacOptions{.confidence = 1}.Check().ok());
  EXPECT_FALSE(RansacOptions{.max_iterations = 0}.Check().ok());
}

}  // namespace
}  // namespace msf
