// What the table builders share.
#pragma once

#include <fmt/format.h>

#include <optional>
#include <vector>

#include "bench/repeats.h"
#include "bench/table.h"

namespace msf {

using Runs = std::vector<const TaskResult*>;

inline constexpr double kPercent = 0.01;

// A figure of the literature; 0: not published.
inline Cell PublishedNumber(double value, int decimals, double unit = 1) {
  return {value == 0 ? "" : fmt::format("{:.{}f}", value / unit, decimals), true};
}

// For SpreadOf().
inline auto AteOf() { return FigureOf(&TaskResult::ate_m, &ErrorFigures::rmse); }
inline std::optional<double> KeptOf(const TaskResult& r) { return r.static_kept; }
inline std::optional<double> RemovedOf(const TaskResult& r) { return r.dynamic_removed; }

}  // namespace msf
