#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "evaluation/chart.h"
#include "evaluation/color_scale.h"
#include "evaluation/trajectory_plot.h"

namespace msf {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

// Whether every tag is closed in order; enough to catch a picture that no viewer opens.
bool IsBalanced(const std::string& xml) {
  std::vector<std::string> open;
  for (size_t at = xml.find('<'); at != std::string::npos; at = xml.find('<', at + 1)) {
    const size_t end = xml.find('>', at);
    if (end == std::string::npos) return false;
    const std::string tag = xml.substr(at + 1, end - at - 1);
    if (tag.starts_with('/')) {
      if (open.empty() || open.back() != tag.substr(1)) return false;
      open.pop_back();
    } else if (!tag.ends_with('/')) {
      open.push_back(tag.substr(0, tag.find(' ')));
    }
  }
  return open.empty();
}

size_t Count(const std::string& text, const std::string& part) {
  size_t n = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

Trajectory Circle(int n, double radius) {
  Trajectory t;
  for (int i = 0; i < n; ++i) {
    t.push_back({0.1 * i, Rigid3d(Eigen::Quaterniond::Identity(),
                                  Eigen::Vector3d(radius * std::cos(0.1 * i),
                                                  radius * std::sin(0.1 * i), 0))});
  }
  return t;
}

TEST(Chart, TicksAreRound) {
  EXPECT_THAT(Ticks({0, 1}, 5),
              ElementsAre(0, 0.2, testing::DoubleEq(0.4), testing::DoubleEq(0.6), 0.8, 1));
  EXPECT_THAT(Ticks({-3, 27}, 3), ElementsAre(0, 10, 20));
  EXPECT_THAT(Ticks({0.0011, 0.0034}, 3),
              ElementsAre(testing::DoubleEq(0.002), testing::DoubleEq(0.003)));
  EXPECT_EQ(FormatTick(0.30000000000000004, 0.1), "0.3");
  EXPECT_EQ(FormatTick(-1e-18, 0.05), "0.00");
  EXPECT_EQ(FormatTick(20, 10), "20");
}

TEST(Chart, MapsRangesToItsArea) {
  SvgCanvas canvas(200, 100);
  const Chart chart(canvas, {{50, 10, 100, 80}, "", "", "", {0, 10}, {-1, 1}});
  EXPECT_EQ(chart.ToPixels(0, -1), Eigen::Vector2d(50, 90));
  EXPECT_EQ(chart.ToPixels(5, 1), Eigen::Vector2d(100, 10));
}

TEST(Chart, HasARangeWhateverItIsGiven) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  for (const Range& range : {Range{5, 5},
                             {1e17, 1e17},
                             {1e17, 1e17 + 64},
                             {-1e308, 1e308},
                             {0, 1e-320},
                             {0, kInf},
                             Range::Empty(),
                             {0, std::nan("")}}) {
    SvgCanvas canvas(200, 100);
    const Chart chart(canvas, {{50, 10, 100, 80}, "", "", "", range, range});
    EXPECT_TRUE(IsBalanced(canvas.ToString()));
    EXPECT_THAT(canvas.ToString(), Not(HasSubstr("nan"))) << range.min << " " << range.max;
  }
}

TEST(Chart, EqualUnitsGrowTheSmallerRange) {
  const ChartSpec spec = WithEqualUnits({{0, 0, 200, 100}, "", "", "", {0, 2}, {0, 3}});
  EXPECT_DOUBLE_EQ(spec.x.length() / 200, spec.y.length() / 100);
  EXPECT_DOUBLE_EQ(spec.y.length(), 3);
  EXPECT_DOUBLE_EQ(spec.x.min, 1 - 3);
}

TEST(ColorScale, RunsFromBlueToRedAndClamps) {
  EXPECT_GT(ErrorColor(0).b, ErrorColor(0).r);
  EXPECT_GT(ErrorColor(1).r, ErrorColor(1).b);
  EXPECT_EQ(ErrorColor(-5), ErrorColor(0));
  EXPECT_EQ(ErrorColor(7), ErrorColor(1));
}

TEST(SvgCanvas, EscapesText) {
  SvgCanvas canvas(10, 10);
  canvas.Text({0, 0}, "a<b & c>d");
  EXPECT_THAT(canvas.ToString(), HasSubstr("a&lt;b &amp; c&gt;d"));
  EXPECT_TRUE(IsBalanced(canvas.ToString()));
}

TEST(SvgCanvas, FillsAreasAndHoldsPictures) {
  SvgCanvas canvas(200, 100);
  Chart chart(canvas, {{50, 10, 100, 80}, "", "", "", {0, 10}, {0, 1}});
  const std::vector<Eigen::Vector2d> area = {{0, 0}, {10, 0}, {10, 1}};
  chart.Area(area, {255, 0, 0}, 0.5);
  canvas.Image({1, 2, 30, 40}, "data:image/png;base64,AA==");
  EXPECT_TRUE(IsBalanced(canvas.ToString()));
  EXPECT_THAT(canvas.ToString(), HasSubstr("points=\"50.0,90.0 150.0,90.0 150.0,10.0\""));
  EXPECT_THAT(canvas.ToString(), HasSubstr("href=\"data:image/png;base64,AA==\""));
}

TEST(Plots, ShowEveryEstimate) {
  const Trajectory truth = Circle(200, 1);
  Trajectory wobbly = truth;
  for (size_t i = 0; i < wobbly.size(); i += 7) {
    wobbly[i].T_wc = Rigid3d(Eigen::Quaterniond::Identity(),
                             wobbly[i].T_wc.translation() + Eigen::Vector3d(0, 0, 0.1));
  }
  const std::vector<Evaluation> evaluations = {
      *EvaluateTrajectory("first & best", truth, truth, {.num_input_frames = 200}),
      *EvaluateTrajectory("second", truth, wobbly)};
  for (const std::string& svg : {PlotTrajectories(truth, evaluations), PlotErrors(evaluations)}) {
    EXPECT_TRUE(IsBalanced(svg));
    EXPECT_THAT(svg, HasSubstr("first &amp; best"));
    EXPECT_THAT(svg, HasSubstr("second"));
    EXPECT_THAT(svg, Not(HasSubstr("nan")));
  }
  EXPECT_THAT(PlotTrajectories(truth, evaluations), HasSubstr("coverage 100.0 %"));
}

TEST(Plots, ExtremeStampsAndPositionsAreDrawn) {
  for (const double stamp_s : {1e-300, 1e17, 1e290}) {
    Trajectory truth;
    for (int i = 0; i < 4; ++i) {
      truth.push_back({stamp_s * (1 + 0.1 * i),
                       Rigid3d(Eigen::Quaterniond::Identity(), Eigen::Vector3d(1e17, i, 0))});
    }
    const StatusOr<Evaluation> evaluation = EvaluateTrajectory("e", truth, truth);
    ASSERT_TRUE(evaluation.ok()) << evaluation.message();
    EXPECT_TRUE(IsBalanced(PlotTrajectories(truth, {&*evaluation, 1})));
    EXPECT_TRUE(IsBalanced(PlotErrors({&*evaluation, 1})));
  }
}

TEST(Plots, BreakTheLineWhereTheEstimateIsSilent) {
  const Trajectory truth = Circle(100, 1);
  Trajectory gap = truth;
  gap.erase(gap.begin() + 40, gap.begin() + 50);
  const auto num_lines = [&](const Trajectory& estimate) {
    const std::vector<Evaluation> evaluations = {*EvaluateTrajectory("e", truth, estimate)};
    return Count(PlotErrors(evaluations), "clip-path");
  };
  EXPECT_GT(num_lines(gap), num_lines(truth));
}

}  // namespace
}  // namespace msf
