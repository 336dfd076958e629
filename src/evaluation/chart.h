// A diagram with axes on a canvas.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "evaluation/svg_canvas.h"

namespace msf {

// A closed interval of the quantity on an axis.
struct Range {
  double min = 0;
  double max = 1;
  double length() const { return max - min; }
  void Include(double value);
  // Nothing yet: the first Include() sets both ends.
  static Range Empty();
};

// The round numbers (1, 2 or 5 times a power of ten apart) within the range: about `count` of them.
std::vector<double> Ticks(const Range& range, int count);
// A tick's text with the decimals that `step` needs.
std::string FormatTick(double value, double step);

struct ChartSpec {
  Box area;  // where the curves are; title, ticks and labels lie around it
  std::string title;
  std::string x_label;
  std::string y_label;
  Range x;
  Range y;
};

// The same spec with one range grown, about its middle, so that a unit has the same length on both
// axes.
ChartSpec WithEqualUnits(ChartSpec spec);

class Chart {
 public:
  // Draws title, grid, ticks and labels. `canvas` must outlive the chart. A range that is too short
  // for numbers of its size is widened; one whose length is no finite number becomes [0, 1].
  Chart(SvgCanvas& canvas, ChartSpec spec);

  Eigen::Vector2d ToPixels(double x, double y) const;

  // Points in units of the axes; clipped to the area.
  void Curve(std::span<const Eigen::Vector2d> points, const Stroke& stroke);
  // The area that the points enclose.
  void Area(std::span<const Eigen::Vector2d> points, Color fill, double opacity);

 private:
  void DrawAxes();
  std::vector<Eigen::Vector2d> ToPixels(std::span<const Eigen::Vector2d> points) const;

  SvgCanvas& canvas_;
  const ChartSpec spec_;
  const int clip_;
};

struct LegendEntry {
  std::string name;
  Stroke stroke;
};

// A row of line samples with their names, its upper left corner at `at`.
void DrawLegend(SvgCanvas& canvas, const Eigen::Vector2d& at, std::span<const LegendEntry> entries);

}  // namespace msf
