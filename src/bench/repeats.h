// Figures over the repeats of a run.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/task_result.h"

namespace msf {

struct Spread {
  double median = 0, min = 0, max = 0;
  size_t count = 0;
};

// Nothing for no values.
std::optional<Spread> SpreadOfValues(const std::vector<double>& values);

// Over the results that have the figure; nothing when none has. `figure` takes a TaskResult to an
// optional<double>.
template <typename Figure>
std::optional<Spread> SpreadOf(const std::vector<const TaskResult*>& results, Figure figure) {
  std::vector<double> values;
  for (const TaskResult* result : results) {
    if (const std::optional<double> value = figure(*result)) values.push_back(*value);
  }
  return SpreadOfValues(values);
}
// The figure of an error, for SpreadOf().
inline auto FigureOf(std::optional<ErrorFigures> TaskResult::*error, double ErrorFigures::*figure) {
  return [=](const TaskResult& result) -> std::optional<double> {
    if (!(result.*error)) return std::nullopt;
    return (*(result.*error)).*figure;
  };
}
inline std::optional<double> CoverageOf(const TaskResult& result) { return result.coverage; }

// The median, with so many decimals; "" for nothing.
std::string FormatMedian(const std::optional<Spread>& spread, int decimals, double unit = 1);
// "0.0101-0.0113"; a single value has no range: "".
std::string FormatRange(const std::optional<Spread>& spread, int decimals, double unit = 1);
// The lowest coverage of the repeats, in percent: what is hard must not hide in a median.
std::string FormatCoverage(const std::vector<const TaskResult*>& results);
// "5", or "3 of 5 ok: 2 crashed".
std::string FormatRuns(const std::vector<const TaskResult*>& results);

}  // namespace msf
