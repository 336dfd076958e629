// Pictures of evaluated trajectories.
#pragma once

#include <span>
#include <string>

#include "evaluation/evaluation.h"

namespace msf {

// A longer silence of an estimate interrupts its lines.
inline constexpr double kLineBreak_s = 0.5;

// Each estimate over the true trajectory, from above (x, y) and from the side (x, z), its colour
// saying the absolute error; one row per estimate with a common colour scale. An SVG file's text.
// There must be an estimate.
std::string PlotTrajectories(const Trajectory& truth, std::span<const Evaluation> evaluations);

// Absolute error and relative errors per frame and per second over time, estimates overlaid. An SVG
// file's text.
std::string PlotErrors(std::span<const Evaluation> evaluations);

}  // namespace msf
