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
  ActivationRange best{low_, high_, {}};
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

void ChannelMeans::Count(std::span<const float> numbers, size_t channels, bool channels_last) {
  sums_.resize(channels, 0.0);
  const size_t pixels = numbers.size() / channels;
  for (size_t i = 0; i < numbers.size(); ++i) {
    sums_[channels_last ? i % channels : i / pixels] += numbers[i];
  }
  count_ += static_cast<double>(pixels);
}

std::vector<float> ChannelMeans::Means() const {
  std::vector<float> means;
  for (const double sum : sums_) means.push_back(static_cast<float>(sum / count_));
  return means;
}

namespace {

// What calibration gathers of the values of one network.
class Observations {
 public:
  void Widen(const CompiledNetwork& network) {
    for (const NetworkOutput& value : network.inner_values())
      histograms_[value.name].Widen(value.numbers());
  }

  void Count(CompiledNetwork& network, cv::Size size) {
    for (const NetworkOutput& value : network.inner_values()) {
      histograms_[value.name].Count(value.numbers());
      means_[value.name].Count(value.numbers(), static_cast<size_t>(value.shape[1]),
                               value.channels_last);
    }
    const size_t bytes = static_cast<size_t>(size.area()) * 3;
    std::vector<float> pixels(network.pixels(), network.pixels() + bytes);
    for (float& pixel : pixels) pixel /= 255.0f;
    means_[network.input_name()].Count(pixels, 3, true);
  }

  ActivationRanges Ranges() const {
    ActivationRanges ranges;
    for (const auto& [name, means] : means_) {
      const auto histogram = histograms_.find(name);
      ranges[name] = histogram == histograms_.end() ? ActivationRange{0, 1, {}}
                                                    : histogram->second.BestRange();
      ranges[name].means = means.Means();
    }
    return ranges;
  }

 private:
  std::map<std::string, ValueHistogram> histograms_;
  std::map<std::string, ChannelMeans> means_;
};

}  // namespace

StatusOr<ActivationRanges> Calibrate(const Graph& graph, const CalibrationOptions& options,
                                     const CalibrationImages& images,
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
  Observations observations;
  for (const bool counting : {false, true}) {
    for (int i = 0; i < images.count; ++i) {
      StatusOr<cv::Mat> picture = images.read(i);
      if (!picture.ok()) return picture.status();
      MSF_RETURN_IF_ERROR(CheckImage(*picture));
      Letterbox(picture->size(), *size).Fill(*picture, (*network)->pixels());
      MSF_RETURN_IF_ERROR((*network)->Run());
      counting ? observations.Count(**network, *size) : observations.Widen(**network);
      progress(i + 1 + (counting ? images.count : 0));
    }
  }
  return observations.Ranges();
}

}  // namespace msf
