// The image pyramid's levels as numbers: level l is the image shrunk by factor^l.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace msf {

class ScaleLevels {
 public:
  ScaleLevels(int num_levels, double factor) : factor_(factor) {
    for (int level = 0; level < num_levels; ++level) scales_.push_back(std::pow(factor, level));
  }

  int size() const { return static_cast<int>(scales_.size()); }
  double factor() const { return factor_; }
  // factor^level: level pixels to image pixels.
  double scale(int level) const { return scales_[level]; }
  // Variance of a point's position found at this level, px^2 (1 at level 0).
  double sigma2(int level) const { return scales_[level] * scales_[level]; }
  // The level at which a point of the given ratio max_distance / distance looks as it did when
  // found.
  int Predict(double distance_ratio) const {
    const int level = static_cast<int>(std::ceil(std::log(distance_ratio) / std::log(factor_)));
    return std::clamp(level, 0, size() - 1);
  }

 private:
  double factor_;
  std::vector<double> scales_;
};

}  // namespace msf
