#include "detection/calibration.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "detection/compiled_network.h"
#include "detection/letterbox.h"
#include "detection/onednn_detector.h"

namespace msf {
namespace {

constexpr size_t kBins = 2048;
constexpr int kSearchSteps = 60;

}  // namespace

void ValueHistogram::Widen(std::span<const float> numbers) {
  for (const float x : numbers) {
    low_ = std::min(low_, x);
    high_ = std::max(high_, x);
  }
}

void ValueHistogram::Count(std::span<const float> numbers) {
  counts_.resize(kBins, 0.0);
  if (!(high_ > low_)) return;
  const float scale = static_cast<float>(kBins) / (high_ - low_);
  for (const float x : numbers) {
    const float bin = std::clamp((x - low_) * scale, 0.0f, static_cast<float>(kBins - 1));
    counts_[static_cast<size_t>(bin)] += 1;
  }
}

double ValueHistogram::SquaredError(float low, float high) const {
  const double step = (static_cast<double>(high) - low) / 255;
  const double rounding = step * step / 12;
  const double bin = (static_cast<double>(high_) - low_) / static_cast<double>(kBins);
  double error = 0;
  for (size_t i = 0; i < counts_.size(); ++i) {
    const double x = low_ + (static_cast<double>(i) + 0.5) * bin;
    const double outside = std::max({low - x, x - high, 0.0});
    error += counts_[i] * (rounding + outside * outside);
  }
  return error;
}

ActivationRange ValueHistogram::BestRange() const {
  ActivationRange best{low_, high_};
  double least = SquaredError(low_, high_);
  // One bound after the other: few values have long tails on both sides.
  for (float ActivationRange::*bound : {&ActivationRange::high, &ActivationRange::low}) {
    const float whole = best.*bound;
    for (int i = 1; i < kSearchSteps; ++i) {
      ActivationRange candidate = best;
      candidate.*bound = whole * static_cast<float>(i) / kSearchSteps;
      if (!(candidate.high > candidate.low)) continue;
      const double error = SquaredError(candidate.low, candidate.high);
      if (error < least) {
        least = error;
        best = candidate;
      }
    }
  }
  return best;
}

StatusOr<ActivationRanges> Calibrate(const Graph& graph, const CalibrationOptions& options,
                                     int num_images,
                                     const std::function<StatusOr<cv::Mat>(int)>& image,
                                     const std::function<void(int)>& progress) {
  DetectorOptions detector;
  detector.width = options.width;
  detector.height = options.height;
  StatusOr<cv::Size> size = InputSizeFor(detector, graph);
  if (!size.ok()) return size.status();
  CompileOptions compile;
  compile.width = size->width;
  compile.height = size->height;
  compile.keep_values = true;
  auto network = CompiledNetwork::Compile(graph, compile);
  if (!network.ok()) return network.status();
  std::map<std::string, ValueHistogram> histograms;
  for (const bool counting : {false, true}) {
    for (int i = 0; i < num_images; ++i) {
      StatusOr<cv::Mat> picture = image(i);
      if (!picture.ok()) return picture.status();
      MSF_RETURN_IF_ERROR(CheckImage(*picture));
      Letterbox(picture->size(), *size).Fill(*picture, (*network)->pixels());
      MSF_RETURN_IF_ERROR((*network)->Run());
      (*network)->VisitValues([&](const std::string& name, std::span<const float> numbers) {
        counting ? histograms[name].Count(numbers) : histograms[name].Widen(numbers);
      });
      progress(i + 1 + (counting ? num_images : 0));
    }
  }
  ActivationRanges ranges;
  for (const auto& [name, histogram] : histograms) ranges[name] = histogram.BestRange();
  return ranges;
}

}  // namespace msf
