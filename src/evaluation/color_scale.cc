#include "evaluation/color_scale.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace msf {
namespace {

constexpr std::array<Color, 6> kScale = {{{0x2b, 0x3f, 0xa0},
                                          {0x1c, 0x8f, 0xc0},
                                          {0x22, 0xa8, 0x6b},
                                          {0x9c, 0xbf, 0x2a},
                                          {0xf0, 0x9a, 0x1a},
                                          {0xd0, 0x1c, 0x1f}}};

// Okabe and Ito's colours, told apart with any kind of colour vision, in an order that suits thin
// lines.
constexpr std::array<Color, 8> kLines = {{{0x00, 0x72, 0xb2},
                                          {0xd5, 0x5e, 0x00},
                                          {0x00, 0x9e, 0x73},
                                          {0xcc, 0x79, 0xa7},
                                          {0x56, 0xb4, 0xe9},
                                          {0xe6, 0x9f, 0x00},
                                          {0x7a, 0x52, 0x30},
                                          {0x77, 0x77, 0x77}}};

}  // namespace

Color ErrorColor(double share) {
  const double position = std::clamp(share, 0.0, 1.0) * (kScale.size() - 1);
  const auto below = std::min(static_cast<size_t>(position), kScale.size() - 2);
  const double part = position - static_cast<double>(below);
  const Color &a = kScale[below], &b = kScale[below + 1];
  const auto mix = [part](uint8_t from, uint8_t to) {
    return static_cast<uint8_t>(std::lround(std::lerp(from, to, part)));
  };
  return {mix(a.r, b.r), mix(a.g, b.g), mix(a.b, b.b)};
}

Color LineColor(size_t index) { return kLines[index % kLines.size()]; }

void DrawColorBar(SvgCanvas& canvas, const Box& box, const Range& range, const std::string& label) {
  constexpr int kSteps = 100, kTickCount = 5;
  const double step = box.height / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    // Neighbours overlap by a pixel, so that no renderer shows seams.
    canvas.FillBox(
        {box.left, box.bottom() - (i + 1) * step, box.width, std::min(step + 1, (i + 1) * step)},
        ErrorColor((i + 0.5) / kSteps));
  }
  const std::vector<double> ticks = Ticks(range, kTickCount);
  const double tick_step = ticks.size() > 1 ? ticks[1] - ticks[0] : range.length();
  for (const double value : ticks) {
    const double y = box.bottom() - (value - range.min) / range.length() * box.height;
    canvas.Line({box.right(), y}, {box.right() + 4, y}, {{0x55, 0x55, 0x55}});
    canvas.Text({box.right() + 7, y + 4}, FormatTick(value, tick_step), {.size = 11});
  }
  canvas.Text({box.right() + 58, box.top + box.height / 2}, label,
              {.anchor = "middle", .upwards = true});
}

}  // namespace msf
