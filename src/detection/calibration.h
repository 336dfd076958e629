// Finds for every value inside a network the span of numbers that 8 bits should represent.
#pragma once

#include <functional>
#include <opencv2/core/mat.hpp>
#include <span>
#include <string>
#include <vector>

#include "detection/graph.h"
#include "detection/storage_plan.h"

namespace msf {

// How often numbers of each size occur in one value, over all calibration images.
class ValueHistogram {
 public:
  // First pass: the extremes.
  void Widen(std::span<const float> numbers);
  // Second pass, after all images widened it: the counts.
  void Count(std::span<const float> numbers);

  // The span, containing 0, for which rounding to 256 levels and cutting what lies outside loses
  // least in the mean square.
  ActivationRange BestRange() const;

 private:
  double SquaredError(float low, float high) const;

  float low_ = 0;
  float high_ = 0;
  std::vector<double> counts_;  // equal bins from low_ to high_
};

struct CalibrationOptions {
  int width = 0;  // input of the network, pixels; 0: the model's own, or 416 x 320
  int height = 0;
};

// The mean of every channel of one value, over all calibration images.
class ChannelMeans {
 public:
  // `numbers` of one image of `channels` channels; in memory [height][width][channel] or
  // [channel][height][width].
  void Count(std::span<const float> numbers, size_t channels, bool channels_last);
  std::vector<float> Means() const;

 private:
  std::vector<double> sums_;
  double count_ = 0;  // per channel
};

struct CalibrationImages {
  int count = 0;
  std::function<StatusOr<cv::Mat>(int)> read;  // image i: 8-bit BGR or grey
};

// Runs the network in float32 over all images (twice) and returns range and means of every value;
// of the input only the means matter. `progress(done)` is told how many of 2 * images.count runs
// are done.
StatusOr<ActivationRanges> Calibrate(const Graph& graph, const CalibrationOptions& options,
                                     const CalibrationImages& images,
                                     const std::function<void(int)>& progress);

}  // namespace msf
