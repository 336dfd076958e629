// What the tables say about a set of errors.
#pragma once

#include <span>

namespace msf {

struct Statistics {
  double rmse = 0;
  double mean = 0;
  double median = 0;  // the mean of the middle two for an even count
  double std = 0;     // of the population (divided by n)
  double min = 0;
  double max = 0;
};

// `values` must not be empty.
Statistics ComputeStatistics(std::span<const double> values);

// The value below which `share` (0..1) of the values lie, interpolated linearly. `values` must not
// be empty.
double Percentile(std::span<const double> values, double share);

}  // namespace msf
