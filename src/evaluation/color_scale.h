// Colours for numbers.
#pragma once

#include <cstddef>

#include "evaluation/chart.h"
#include "evaluation/svg_canvas.h"

namespace msf {

// From blue (0) over green to red (1), readable on white. Values outside are clamped.
Color ErrorColor(double share);

// A bar of the colours with ticks and a label to its right.
void DrawColorBar(SvgCanvas& canvas, const Box& box, const Range& range, const std::string& label);

// Colours that tell lines apart; they repeat after eight.
Color LineColor(size_t index);

}  // namespace msf
