#include "bench/repeats.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "evaluation/statistics.h"

namespace msf {

std::optional<Spread> SpreadOfValues(const std::vector<double>& values) {
  if (values.empty()) return std::nullopt;
  const Statistics statistics = ComputeStatistics(values);
  return Spread{statistics.median, statistics.min, statistics.max, values.size()};
}

std::string FormatMedian(const std::optional<Spread>& spread, int decimals, double unit) {
  return spread ? fmt::format("{:.{}f}", spread->median / unit, decimals) : "";
}

std::string FormatRange(const std::optional<Spread>& spread, int decimals, double unit) {
  if (!spread || spread->count < 2) return "";
  return fmt::format("{:.{}f}-{:.{}f}", spread->min / unit, decimals, spread->max / unit, decimals);
}

std::string FormatCoverage(const std::vector<const TaskResult*>& results) {
  const std::optional<Spread> coverage = SpreadOf(results, CoverageOf);
  return coverage ? fmt::format("{:.1f} %", 100 * coverage->min) : "";
}

std::string FormatRuns(const std::vector<const TaskResult*>& results) {
  std::map<std::string, int> problems;
  int num_ok = 0;
  for (const TaskResult* result : results) {
    if (result->ok())
      ++num_ok;
    else
      ++problems[result->status];
  }
  if (problems.empty()) return std::to_string(num_ok);
  std::string text = fmt::format("{} of {} ok", num_ok, results.size());
  const char* separator = ": ";
  for (const auto& [status, count] : problems) {
    text += fmt::format("{}{} {}", separator, count, status);
    separator = ", ";
  }
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

}  // namespace msf
