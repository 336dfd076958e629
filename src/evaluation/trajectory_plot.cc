#include "evaluation/trajectory_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "evaluation/chart.h"
#include "evaluation/color_scale.h"
#include "evaluation/statistics.h"

namespace msf {
namespace {

constexpr int kColorLevels = 32;
constexpr Stroke kTruthStroke = {{0x8a, 0x8a, 0x8a}, 1.6, "5 3"};
constexpr double kRow = 516, kPanel = 390, kPanelTop = 76, kPanelLeft = 74, kBetween = 92;
constexpr double kBarLeft = kPanelLeft + 2 * kPanel + kBetween + 26, kBarWidth = 16;
constexpr double kWidth = kBarLeft + kBarWidth + 84;

struct View {
  const char* title;
  int horizontal, vertical;  // which coordinates
};
constexpr View kViews[] = {{"from above", 0, 1}, {"from the side", 0, 2}};
constexpr const char* kAxisNames[] = {"x [m]", "y [m]", "z [m]"};

struct TimedPoint {
  double time_s;
  Eigen::Vector3d p_w;
  double error_m;
};
using Path = std::vector<TimedPoint>;

Path AlignedEstimate(const Evaluation& e) {
  Path path;
  for (size_t i = 0; i < e.pairs.size(); ++i) {
    path.push_back({e.pairs[i].time_s,
                    e.absolute.T_true_estimated * e.pairs[i].estimated_T_wc.translation(),
                    e.absolute.translation_m.value[i]});
  }
  return path;
}

// The truth while any estimate runs: motion capture often starts long before the camera.
Path VisibleTruth(const Trajectory& truth, std::span<const Evaluation> evaluations) {
  Range time = Range::Empty();
  for (const Evaluation& e : evaluations) {
    time.Include(e.pairs.front().time_s);
    time.Include(e.pairs.back().time_s);
  }
  Path path;
  for (const StampedPose& pose : truth) {
    if (pose.time_s >= time.min - kMaxAssociationGap_s &&
        pose.time_s <= time.max + kMaxAssociationGap_s) {
      path.push_back({pose.time_s, pose.T_wc.translation(), 0});
    }
  }
  return path;
}

Range RangeOf(const std::vector<const Path*>& paths, int coordinate) {
  Range range = Range::Empty();
  for (const Path* path : paths) {
    for (const TimedPoint& point : *path) range.Include(point.p_w[coordinate]);
  }
  const double margin = std::max(0.05 * range.length(), 0.01);
  return {range.min - margin, range.max + margin};
}

// Draws pieces of equal colour as one line each, with a break where the estimate is silent.
void DrawPath(Chart& chart, const Path& path, const View& view, double width, auto color_of,
              const char* dashes) {
  std::vector<Eigen::Vector2d> piece;
  Color color;
  const auto flush = [&] {
    if (piece.size() > 1) chart.Curve(piece, {color, width, dashes});
  };
  for (size_t i = 0; i < path.size(); ++i) {
    const Eigen::Vector2d point(path[i].p_w[view.horizontal], path[i].p_w[view.vertical]);
    const Color next = color_of(path[i]);
    const bool silent = i > 0 && path[i].time_s - path[i - 1].time_s > kLineBreak_s;
    if (piece.empty() || silent || !(next == color)) {
      flush();
      if (silent || piece.empty())
        piece = {point};
      else
        piece = {piece.back(), point};
      color = next;
    } else {
      piece.push_back(point);
    }
  }
  flush();
}

void DrawRow(SvgCanvas& canvas, double top, const Evaluation& e, const Path& truth,
             const Range& error_m) {
  const Path estimate = AlignedEstimate(e);
  const auto error_color = [&](const TimedPoint& p) {
    return ErrorColor(std::round((p.error_m - error_m.min) / error_m.length() * kColorLevels) /
                      kColorLevels);
  };
  double left = kPanelLeft;
  for (const View& view : kViews) {
    ChartSpec spec{{left, top + kPanelTop, kPanel, kPanel},
                   view.title,
                   kAxisNames[view.horizontal],
                   kAxisNames[view.vertical],
                   RangeOf({&truth, &estimate}, view.horizontal),
                   RangeOf({&truth, &estimate}, view.vertical)};
    Chart chart(canvas, WithEqualUnits(std::move(spec)));
    DrawPath(
        chart, truth, view, kTruthStroke.width,
        [](const TimedPoint&) { return kTruthStroke.color; }, kTruthStroke.dashes);
    DrawPath(chart, estimate, view, 2.2, error_color, "");
    left += kPanel + kBetween;
  }
  DrawColorBar(canvas, {kBarLeft, top + kPanelTop, kBarWidth, kPanel}, error_m,
               "absolute error [m]");
}

}  // namespace

std::string PlotTrajectories(const Trajectory& truth, std::span<const Evaluation> evaluations) {
  const Path visible_truth = VisibleTruth(truth, evaluations);
  Range error_m = {0, 1e-6};
  for (const Evaluation& e : evaluations)
    error_m.Include(ComputeStatistics(e.absolute.translation_m.value).max);

  const auto num_rows = static_cast<double>(evaluations.size());
  SvgCanvas canvas(kWidth, num_rows * kRow);
  double top = 0;
  for (const Evaluation& e : evaluations) {
    const std::string coverage =
        e.Coverage() ? fmt::format(", coverage {:.1f} %", 100 * *e.Coverage()) : "";
    canvas.Text({kPanelLeft, top + 22},
                fmt::format("{}: ATE RMSE {:.4f} m{}", e.name,
                            ComputeStatistics(e.absolute.translation_m.value).rmse, coverage),
                {.size = 15, .bold = true});
    const LegendEntry legend[] = {{"ground truth", kTruthStroke},
                                  {"estimate, coloured by its error", {ErrorColor(0.4), 2.2}}};
    DrawLegend(canvas, {kPanelLeft, top + 32}, legend);
    DrawRow(canvas, top, e, visible_truth, error_m);
    top += kRow;
  }
  return canvas.ToString();
}

}  // namespace msf
