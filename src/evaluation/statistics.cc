#include "evaluation/statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "util/check.h"

namespace msf {

double Percentile(std::span<const double> values, double share) {
  MSF_CHECK(!values.empty(), "no values");
  MSF_CHECK(share >= 0 && share <= 1, "a share lies between 0 and 1");
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  const double position = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<size_t>(position);
  const size_t above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], position - static_cast<double>(below));
}

Statistics ComputeStatistics(std::span<const double> values) {
  MSF_CHECK(!values.empty(), "no values");
  const auto n = static_cast<double>(values.size());
  Statistics statistics;
  statistics.mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double sum_squares = 0, sum_squared_deviations = 0;
  for (const double value : values) {
    sum_squares += value * value;
    sum_squared_deviations += (value - statistics.mean) * (value - statistics.mean);
  }
  statistics.rmse = std::sqrt(sum_squares / n);
  statistics.std = std::sqrt(sum_squared_deviations / n);
  statistics.median = Percentile(values, 0.5);
  const auto [min, max] = std::minmax_element(values.begin(), values.end());
  statistics.min = *min;
  statistics.max = *max;
  return statistics;
}

}  // namespace msf
