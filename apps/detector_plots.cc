#include "apps/detector_plots.h"

#include <fmt/format.h>

#include <cmath>

#include "evaluation/svg_canvas.h"

namespace msf {
namespace {

constexpr Box kPlot{60, 40, 480, 480};
constexpr double kWidth = 760, kHeight = 580;

Eigen::Vector2d Place(double recall, double precision) {
  return {kPlot.left + recall * kPlot.width, kPlot.bottom() - precision * kPlot.height};
}

// Colours around the circle, darker every second time.
Color ColorOf(size_t index, size_t count) {
  const double hue = 6.0 * static_cast<double>(index) / static_cast<double>(count);
  const double value = index % 2 == 0 ? 0.85 : 0.6;
  const auto channel = [&](double offset) {
    const double k = std::fmod(offset + hue, 6.0);
    return static_cast<uint8_t>(
        255 * (value - value * 0.85 * std::clamp(std::min(k, 4.0 - k), 0.0, 1.0)));
  };
  return {channel(5), channel(3), channel(1)};
}

void DrawAxes(SvgCanvas& canvas) {
  const Stroke grid{{0xdd, 0xdd, 0xdd}, 1, ""};
  for (int i = 0; i <= 10; i += 2) {
    const double t = i / 10.0;
    canvas.Line(Place(t, 0), Place(t, 1), grid);
    canvas.Line(Place(0, t), Place(1, t), grid);
    canvas.Text(Place(t, 0) + Eigen::Vector2d(0, 18), fmt::format("{:.1f}", t), {12, "middle"});
    canvas.Text(Place(0, t) + Eigen::Vector2d(-8, 4), fmt::format("{:.1f}", t), {12, "end"});
  }
  canvas.Text({kPlot.left + kPlot.width / 2, kHeight - 20}, "recall", {13, "middle"});
  TextStyle upwards{13, "middle"};
  upwards.upwards = true;
  canvas.Text({20, kPlot.top + kPlot.height / 2}, "precision", upwards);
}

}  // namespace

std::string PlotPrecisionRecall(const DetectionMetrics& metrics,
                                const std::vector<std::string>& class_names, int min_objects) {
  SvgCanvas canvas(kWidth, kHeight);
  canvas.Text({kPlot.left, 26},
              fmt::format("Precision and recall at IoU 0.5, mAP50 {:.3f} over {} classes",
                          metrics.map50, metrics.num_classes),
              {14, "start"});
  DrawAxes(canvas);
  double row = kPlot.top + 10;
  for (size_t i = 0; i < metrics.per_class.size(); ++i) {
    const ClassMetrics& c = metrics.per_class[i];
    if (c.num_objects < min_objects) continue;
    std::vector<Eigen::Vector2d> points{Place(0, 1)};
    for (const OperatingPoint& p : c.curve) points.push_back(Place(p.recall, p.precision));
    const Stroke stroke{ColorOf(i, metrics.per_class.size()), 1.5, ""};
    canvas.Polyline(points, stroke);
    canvas.Line({kPlot.right() + 16, row - 4}, {kPlot.right() + 40, row - 4}, stroke);
    canvas.Text({kPlot.right() + 46, row}, fmt::format("{} {:.3f}", class_names[i], c.ap50));
    row += 20;
  }
  return canvas.ToString();
}

}  // namespace msf
