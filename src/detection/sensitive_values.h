// Finds the values inside a network that lose most when 8 bits represent them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "detection/calibration.h"
#include "detection/graph.h"
#include "detection/storage_plan.h"

namespace msf {

struct SensitivityOptions {
  int max_values = 6;       // at most so many are named
  double max_share = 0.02;  // of the multiply-adds: at most so many leave 8 bits, since they take
                            // about four times as long then
  double min_gain = 0.03;   // each lessens the error by at least this share of it
  int max_images = 40;      // spread evenly over those given
};

struct SensitiveValues {
  std::vector<std::string> names;  // the one that gains most first
  // Root mean square of int8 scores minus float32 scores, over the cells and classes that either
  // scores 0.05 or more: with all ranges, and without those of `names`.
  double error_with = 0;
  double error_without = 0;
  double share = 0;  // of the multiply-adds of the network that leave 8 bits with `names`
};

// A value without a range stays in the higher precision, and so do the convolutions that read it.
// Takes one after the other the value whose absence from `ranges` brings the int8 scores nearest to
// those of float32. `progress(done, total)` is told of the trials, one network over all images
// each. Deterministic.
StatusOr<SensitiveValues> FindSensitiveValues(const Graph& graph, const ActivationRanges& ranges,
                                              const CalibrationOptions& size,
                                              const SensitivityOptions& options,
                                              const CalibrationImages& images,
                                              const std::function<void(int, int)>& progress);

}  // namespace msf
