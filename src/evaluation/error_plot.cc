#include <fmt/format.h>

#include <algorithm>

#include "evaluation/chart.h"
#include "evaluation/color_scale.h"
#include "evaluation/statistics.h"
#include "evaluation/trajectory_plot.h"

namespace msf {
namespace {

constexpr double kWidth = 960, kLeft = 76, kRight = 24, kTop = 66, kLegendRow = 18, kPanel = 170,
                 kRow = 246;

struct Panel {
  const char* title;
  const char* label;
  const ErrorSeries& (*series)(const Evaluation&);
};

const ErrorSeries& Absolute(const Evaluation& e) { return e.absolute.translation_m; }
const ErrorSeries& PerFrame(const Evaluation& e) { return e.per_frame.translation_m; }
const ErrorSeries& PerSecond(const Evaluation& e) { return e.per_second.translation_m; }

constexpr Panel kPanels[] = {{"absolute error (ATE)", "error [m]", Absolute},
                             {"relative error of one frame (RPE)", "error [m]", PerFrame},
                             {"relative error of one second (RPE)", "error [m]", PerSecond}};

void DrawSeries(Chart& chart, const ErrorSeries& series, double start_s, const Stroke& stroke) {
  std::vector<Eigen::Vector2d> piece;
  for (size_t i = 0; i < series.value.size(); ++i) {
    if (i > 0 && series.time_s[i] - series.time_s[i - 1] > kLineBreak_s) {
      chart.Curve(piece, stroke);
      piece.clear();
    }
    piece.emplace_back(series.time_s[i] - start_s, series.value[i]);
  }
  chart.Curve(piece, stroke);
}

void DrawPanel(SvgCanvas& canvas, double top, const Panel& panel,
               std::span<const Evaluation> evaluations, const Range& time_s) {
  Range error = {0, 1e-6};
  for (const Evaluation& e : evaluations) {
    for (const double value : panel.series(e).value) error.Include(value);
  }
  error.max *= 1.05;
  Chart chart(canvas, {{kLeft, top, kWidth - kLeft - kRight, kPanel},
                       panel.title,
                       "time [s]",
                       panel.label,
                       {0, time_s.length()},
                       error});
  for (size_t i = 0; i < evaluations.size(); ++i) {
    DrawSeries(chart, panel.series(evaluations[i]), time_s.min, {LineColor(i), 1.3});
  }
}

}  // namespace

std::string PlotErrors(std::span<const Evaluation> evaluations) {
  const double top = kTop + kLegendRow * static_cast<double>(evaluations.size());
  SvgCanvas canvas(kWidth, top + kRow * std::size(kPanels) - 20);
  canvas.Text({kLeft, 24}, "Errors over time", {.size = 15, .bold = true});
  Range time_s = Range::Empty();
  for (size_t i = 0; i < evaluations.size(); ++i) {
    const Evaluation& e = evaluations[i];
    time_s.Include(e.pairs.front().time_s);
    time_s.Include(e.pairs.back().time_s);
    const double rmse = ComputeStatistics(e.absolute.translation_m.value).rmse;
    const LegendEntry entry[] = {
        {fmt::format("{} (ATE RMSE {:.4f} m)", e.name, rmse), {LineColor(i), 2.2}}};
    DrawLegend(canvas, {kLeft, 34 + kLegendRow * static_cast<double>(i)}, entry);
  }
  for (size_t i = 0; i < std::size(kPanels); ++i) {
    DrawPanel(canvas, top + kRow * static_cast<double>(i), kPanels[i], evaluations, time_s);
  }
  return canvas.ToString();
}

}  // namespace msf
