// Random sample consensus (Fischler & Bolles, 1981), with as many trials as the best model so far
// makes necessary.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "util/status.h"

namespace msf {

struct RansacOptions {
  double confidence = 0.99;
  int max_iterations = 300;
  int min_inliers = 10;
  uint64_t seed = 0;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("confidence", confidence, "probability of having drawn a sample without outliers");
    visit("max_iterations", max_iterations, "samples drawn at most");
    visit("min_inliers", min_inliers, "inliers without which there is no result");
    visit("seed", seed, "of the samples; equal seeds give equal results");
  }
  Status Check() const {
    if (!(confidence > 0 && confidence < 1))
      return Status::Error("ransac: confidence must lie between 0 and 1");
    if (max_iterations < 1) return Status::Error("ransac: max_iterations must be at least 1");
    if (min_inliers < 1) return Status::Error("ransac: min_inliers must be at least 1");
    return Status::Ok();
  }
};

template <typename Model>
struct Consensus {
  Model model;
  std::vector<uint8_t> inlier;  // per datum
  int num_inliers = 0;
};

// Samples needed to draw one of `sample_size` inliers only with the given confidence when a share
// `inlier_share` of the data are inliers; at most `max_iterations`.
inline int RansacIterations(double inlier_share, int sample_size, double confidence,
                            int max_iterations) {
  const double good_sample = std::pow(inlier_share, sample_size);
  if (good_sample >= 1) return 1;
  const double needed = std::log1p(-confidence) / std::log1p(-good_sample);
  return needed < max_iterations ? std::max(1, static_cast<int>(std::ceil(needed)))
                                 : max_iterations;
}

// kSampleSize different indices below `size` (>= kSampleSize).
template <int kSampleSize>
std::array<int, kSampleSize> DrawSample(int size, std::mt19937_64& random) {
  std::array<int, kSampleSize> sample{};
  for (int i = 0; i < kSampleSize; ++i) {
    do {
      sample[i] = static_cast<int>(random() % static_cast<uint64_t>(size));
    } while (std::find(sample.begin(), sample.begin() + i, sample[i]) != sample.begin() + i);
  }
  return sample;
}

// The inliers of `model` among `size` data.
template <typename Model, typename IsInlier>
Consensus<Model> FindConsensus(const Model& model, int size, IsInlier is_inlier) {
  Consensus<Model> consensus{model, std::vector<uint8_t>(size), 0};
  for (int i = 0; i < size; ++i) consensus.num_inliers += consensus.inlier[i] = is_inlier(model, i);
  return consensus;
}

// The model with the most inliers among those that `fit(sample, models)` appends for random samples
// of kSampleSize of the `size` data, by `is_inlier(model, i)`. Nothing when fewer than min_inliers
// agree with every model. The first of equals wins.
template <typename Model, int kSampleSize, typename Fit, typename IsInlier>
std::optional<Consensus<Model>> Ransac(int size, const RansacOptions& options, Fit fit,
                                       IsInlier is_inlier) {
  if (size < std::max(kSampleSize, options.min_inliers)) return std::nullopt;
  std::mt19937_64 random(options.seed);
  std::optional<Consensus<Model>> best;
  std::vector<Model> models;
  int needed = options.max_iterations;
  for (int iteration = 0; iteration < needed; ++iteration) {
    models.clear();
    fit(DrawSample<kSampleSize>(size, random), models);
    for (const Model& model : models) {
      Consensus<Model> consensus = FindConsensus(model, size, is_inlier);
      if (consensus.num_inliers < options.min_inliers) continue;
      if (best && consensus.num_inliers <= best->num_inliers) continue;
      best = std::move(consensus);
      needed = RansacIterations(static_cast<double>(best->num_inliers) / size, kSampleSize,
                                options.confidence, options.max_iterations);
    }
  }
  return best;
}

}  // namespace msf
