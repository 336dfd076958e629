// Figures 5 and 6: where the camera was, where it was said to be, and the error between the two.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "bench/figures.h"
#include "bench/run_record.h"
#include "evaluation/chart.h"
#include "evaluation/statistics.h"
#include "evaluation/trajectory_plot.h"

namespace msf {
namespace {

constexpr Stroke kTruth = {{0x22, 0x22, 0x22}, 1.6};
constexpr Stroke kEstimate = {{0x1f, 0x5f, 0xc4}, 1.6};
constexpr Color kError = {0xd6, 0x2b, 0x2b};
constexpr double kPanel = 430, kLeft = 70, kBetween = 84, kTop = 92, kBottom = 60;

struct View {
  const char* figure;
  const char* from;
  std::array<int, 2> axes;
  std::array<const char*, 2> labels;
};
constexpr View kViews[] = {{"5", "from above", {0, 1}, {"x [m]", "y [m]"}},
                           {"6", "from the side", {0, 2}, {"x [m]", "z [m]"}}};

struct Line {
  std::vector<Eigen::Vector2d> truth, estimate;  // of the same moments
};

// Cut where the estimate is silent, so that no line pretends to know what was there.
std::vector<Line> LinesOf(const Evaluation& e, const View& view) {
  std::vector<Line> lines;
  for (size_t i = 0; i < e.pairs.size(); ++i) {
    if (i == 0 || e.pairs[i].time_s - e.pairs[i - 1].time_s > kLineBreak_s) lines.emplace_back();
    const Eigen::Vector3d truth = e.pairs[i].true_T_wc.translation();
    const Eigen::Vector3d estimate =
        e.absolute.T_true_estimated * e.pairs[i].estimated_T_wc.translation();
    lines.back().truth.emplace_back(truth[view.axes[0]], truth[view.axes[1]]);
    lines.back().estimate.emplace_back(estimate[view.axes[0]], estimate[view.axes[1]]);
  }
  return lines;
}

// Each step of the two lines and the two errors at its ends enclose an area.
void DrawErrorArea(Chart& chart, const Line& line) {
  for (size_t i = 0; i + 1 < line.truth.size(); ++i) {
    const std::array quad = {line.truth[i], line.truth[i + 1], line.estimate[i + 1],
                             line.estimate[i]};
    chart.Area(quad, kError, 0.45);
  }
}

ChartSpec SpecOf(double left, const RunRecord& run, const View& view,
                 const std::vector<RunRecord>& all) {
  Range x = Range::Empty(), y = Range::Empty();
  for (const RunRecord& record : all) {
    for (const Line& line : LinesOf(record.evaluation, view)) {
      for (const auto* points : {&line.truth, &line.estimate}) {
        for (const Eigen::Vector2d& p : *points) {
          x.Include(p.x());
          y.Include(p.y());
        }
      }
    }
  }
  for (Range* range : {&x, &y}) {
    const double margin = std::max(0.05 * range->length(), 0.01);
    *range = {range->min - margin, range->max + margin};
  }
  const double rmse = ComputeStatistics(run.evaluation.absolute.translation_m.value).rmse;
  return WithEqualUnits({{left, kTop, kPanel, kPanel},
                         fmt::format("{}: ATE {:.4f} m, coverage {:.1f} %", run.variant, rmse,
                                     100 * run.evaluation.Coverage().value_or(0)),
                         view.labels[0],
                         view.labels[1],
                         x,
                         y});
}

Figure Draw(const SuiteSequence& sequence, const std::vector<RunRecord>& runs, const View& view) {
  const auto count = static_cast<double>(runs.size());
  SvgCanvas canvas(kLeft + count * kPanel + (count - 1) * kBetween + 30, kTop + kPanel + kBottom);
  const std::string title =
      fmt::format("Figure {}: {}, truth and estimate {}", view.figure, sequence.name, view.from);
  canvas.Text({kLeft, 26}, title, {.size = 15, .bold = true});
  const LegendEntry legend[] = {
      {"ground truth", kTruth}, {"estimate", kEstimate}, {"error between them", {kError, 6}}};
  DrawLegend(canvas, {kLeft, 40}, legend);
  double left = kLeft;
  for (const RunRecord& run : runs) {
    Chart chart(canvas, SpecOf(left, run, view, runs));
    const std::vector<Line> lines = LinesOf(run.evaluation, view);
    for (const Line& line : lines) DrawErrorArea(chart, line);
    for (const Line& line : lines) {
      chart.Curve(line.truth, kTruth);
      chart.Curve(line.estimate, kEstimate);
    }
    left += kPanel + kBetween;
  }
  return {fmt::format("figure{}_{}", view.figure, sequence.name), "", title, "", canvas.ToString()};
}

}  // namespace

std::vector<Figure> TrajectoryFigures(const std::filesystem::path& out,
                                      const BenchResults& results) {
  std::vector<Figure> figures;
  std::vector<Figure> sides;
  for (const SuiteSequence& sequence : results.suite.sequences) {
    std::vector<RunRecord> runs = LoadRuns(out, results, sequence);
    if (runs.empty()) continue;
    if (runs.size() > 2) runs.erase(runs.begin() + 2, runs.end());
    figures.push_back(Draw(sequence, runs, kViews[0]));
    sides.push_back(Draw(sequence, runs, kViews[1]));
  }
  std::move(sides.begin(), sides.end(), std::back_inserter(figures));
  return figures;
}

}  // namespace msf
