// Two results.json next to each other: has anything become worse?
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "util/status.h"

namespace msf {

struct ComparisonOptions {
  double tolerance = 0.1;             // share by which a median error may grow ...
  double slack_m = 0.0005;            // ... or, where that is more, so many metres
  double coverage_tolerance = 0.005;  // share of the frames by which the coverage may fall
  double time_tolerance = 0;          // share by which the median latency may grow; 0: not compared
};

struct ComparisonRow {
  std::string sequence, variant, measure;
  double before = 0, after = 0;
  std::string verdict;  // "same", "better", "worse", "gone", "fails"
  bool is_regression = false;
};

struct Comparison {
  std::vector<ComparisonRow> rows;
  size_t NumRegressions() const;
};

// What `before` has and `after` has not, or worse, is a regression; what only `after` has is not
// looked at. Times come from the timing.json beside each file.
StatusOr<Comparison> CompareResults(const std::filesystem::path& before,
                                    const std::filesystem::path& after,
                                    const ComparisonOptions& options);

// A table with a summary below.
std::string FormatComparison(const Comparison& comparison);

}  // namespace msf
