#include "evaluation/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "util/check.h"

namespace msf {
namespace {

constexpr Color kFrame = {0x55, 0x55, 0x55};
constexpr Color kGrid = {0xe4, 0xe4, 0xe4};
constexpr double kTickLength = 4;
constexpr double kTickText = 11;
constexpr double kLabelText = 12;
constexpr double kTitleText = 13;
constexpr double kPixelsPerTickX = 70;
constexpr double kPixelsPerTickY = 36;

double TickStep(const Range& range, int count) {
  const double rough = range.length() / std::max(count, 1);
  const double power = std::pow(10, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= rough * (1 - 1e-9)) return factor * power;
  }
  return 10 * power;
}

// The range, widened where it is too short for numbers of its size; [0, 1] when it has no length
// that is a number.
Range Drawable(const Range& range) {
  constexpr double kLeastShare = 1e-9, kLeast = 1e-9;
  if (!std::isfinite(range.length())) return {0, 1};
  const double size = std::max(std::abs(range.min), std::abs(range.max));
  const double missing = std::max(kLeastShare * size, kLeast) - range.length();
  if (missing <= 0) return range;
  return {range.min - missing / 2, range.max + missing / 2};
}

ChartSpec Drawable(ChartSpec spec) {
  spec.x = Drawable(spec.x);
  spec.y = Drawable(spec.y);
  return spec;
}

int TickCount(double pixels, double pixels_per_tick) {
  return std::clamp(static_cast<int>(pixels / pixels_per_tick), 2, 10);
}

}  // namespace

Range Range::Empty() {
  return {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
}

void Range::Include(double value) {
  min = std::min(min, value);
  max = std::max(max, value);
}

std::vector<double> Ticks(const Range& range, int count) {
  MSF_CHECK(range.length() > 0, "an axis needs a range");
  const double step = TickStep(range, count);
  std::vector<double> ticks;
  for (double k = std::ceil(range.min / step - 1e-9); k * step <= range.max + 1e-9 * step; ++k)
    ticks.push_back(k * step);
  return ticks;
}

std::string FormatTick(double value, double step) {
  const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
  return fmt::format("{:.{}f}", std::abs(value) < step * 1e-6 ? 0.0 : value, decimals);
}

ChartSpec WithEqualUnits(ChartSpec spec) {
  const double unit =
      std::max(spec.x.length() / spec.area.width, spec.y.length() / spec.area.height);
  const auto grow = [](Range& range, double length) {
    const double middle = (range.min + range.max) / 2;
    range = {middle - length / 2, middle + length / 2};
  };
  grow(spec.x, unit * spec.area.width);
  grow(spec.y, unit * spec.area.height);
  return spec;
}

Chart::Chart(SvgCanvas& canvas, ChartSpec spec)
    : canvas_(canvas), spec_(Drawable(std::move(spec))), clip_(canvas.DefineClip(spec_.area)) {
  DrawAxes();
}

Eigen::Vector2d Chart::ToPixels(double x, double y) const {
  return {spec_.area.left + (x - spec_.x.min) / spec_.x.length() * spec_.area.width,
          spec_.area.bottom() - (y - spec_.y.min) / spec_.y.length() * spec_.area.height};
}

void Chart::DrawAxes() {
  const Box& area = spec_.area;
  const int x_count = TickCount(area.width, kPixelsPerTickX),
            y_count = TickCount(area.height, kPixelsPerTickY);
  for (const double x : Ticks(spec_.x, x_count)) {
    const double px = ToPixels(x, 0).x();
    canvas_.Line({px, area.top}, {px, area.bottom()}, {kGrid});
    canvas_.Line({px, area.bottom()}, {px, area.bottom() + kTickLength}, {kFrame});
    canvas_.Text({px, area.bottom() + kTickLength + kTickText + 1},
                 FormatTick(x, TickStep(spec_.x, x_count)),
                 {.size = kTickText, .anchor = "middle"});
  }
  for (const double y : Ticks(spec_.y, y_count)) {
    const double px = ToPixels(0, y).y();
    canvas_.Line({area.left, px}, {area.right(), px}, {kGrid});
    canvas_.Line({area.left - kTickLength, px}, {area.left, px}, {kFrame});
    canvas_.Text({area.left - kTickLength - 3, px + kTickText * 0.35},
                 FormatTick(y, TickStep(spec_.y, y_count)), {.size = kTickText, .anchor = "end"});
  }
  const std::vector<Eigen::Vector2d> frame = {{area.left, area.top},
                                              {area.right(), area.top},
                                              {area.right(), area.bottom()},
                                              {area.left, area.bottom()},
                                              {area.left, area.top}};
  canvas_.Polyline(frame, {kFrame});
  const double middle_x = area.left + area.width / 2, middle_y = area.top + area.height / 2;
  canvas_.Text({middle_x, area.top - 8}, spec_.title,
               {.size = kTitleText, .anchor = "middle", .bold = true});
  canvas_.Text({middle_x, area.bottom() + 34}, spec_.x_label,
               {.size = kLabelText, .anchor = "middle"});
  canvas_.Text({area.left - 48, middle_y}, spec_.y_label,
               {.size = kLabelText, .anchor = "middle", .upwards = true});
}

std::vector<Eigen::Vector2d> Chart::ToPixels(std::span<const Eigen::Vector2d> points) const {
  std::vector<Eigen::Vector2d> pixels;
  pixels.reserve(points.size());
  for (const Eigen::Vector2d& p : points) pixels.push_back(ToPixels(p.x(), p.y()));
  return pixels;
}

void Chart::Curve(std::span<const Eigen::Vector2d> points, const Stroke& stroke) {
  canvas_.ClippedPolyline(ToPixels(points), stroke, clip_);
}

void Chart::Area(std::span<const Eigen::Vector2d> points, Color fill, double opacity) {
  canvas_.FillClippedPolygon(ToPixels(points), fill, opacity, clip_);
}

void DrawLegend(SvgCanvas& canvas, const Eigen::Vector2d& at,
                std::span<const LegendEntry> entries) {
  constexpr double kSample = 26, kGap = 6, kBetween = 22, kCharacter = 7.2;
  double x = at.x();
  for (const LegendEntry& entry : entries) {
    const double y = at.y() + kLabelText / 2;
    canvas.Line({x, y}, {x + kSample, y}, entry.stroke);
    canvas.Text({x + kSample + kGap, y + kLabelText * 0.35}, entry.name, {.size = kLabelText});
    x += kSample + kGap + kCharacter * static_cast<double>(entry.name.size()) + kBetween;
  }
}

}  // namespace msf
