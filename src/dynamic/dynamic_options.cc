#include "dynamic/dynamic_options.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <type_traits>

namespace msf {

namespace {

// Finds the first number that is negative or none: all of these options are lengths, times, shares
// and counts.
struct NegativeFinder {
  std::string section = "dynamic.";
  std::string found;

  void operator()(const char*, std::string&, const char*) {}
  void operator()(const char*, std::vector<std::string>&, const char*) {}
  template <typename Value>
  void operator()(const char* name, Value& value, const char*) {
    if constexpr (std::is_arithmetic_v<Value>) {
      const auto number = static_cast<double>(value);
      if (found.empty() && !(std::isfinite(number) && number >= 0)) found = section + name;
    } else {
      const std::string outer = section;
      section += std::string(name) + ".";
      value.Visit(*this);
      section = outer;
    }
  }
};

}  // namespace

Status DynamicOptions::Check() const {
  constexpr std::array kModes = {"off", "boxes", "paper", "full"};
  if (std::find(kModes.begin(), kModes.end(), mode) == kModes.end())
    return Status::Error("dynamic.mode: '" + mode +
                         "' is not known; known are: off, boxes, paper, full");
  NegativeFinder finder;
  DynamicOptions copy = *this;
  copy.Visit(finder);
  if (!finder.found.empty()) return Status::Error(finder.found + " must not be negative");
  for (const double share :
       {min_static_probability, tracks.min_iou, tracks.moving_share, tracks.settled_share,
        tracks.mover_share, tracks.new_share, tracks.settled_weight, planes.min_share,
        planes.covered_share, mask.min_depth_share, mask.near_depth_share}) {
    if (share > 1) return Status::Error("dynamic: shares and probabilities are at most 1");
  }
  for (const auto& [name, value, most] :
       {std::tuple("mask.grow_px", mask.grow_px, 1000),
        {"mask.grow_without_depth_px", mask.grow_without_depth_px, 1000},
        {"background.num_views", background.num_views, 100},
        {"planes.hypotheses", planes.hypotheses, 10000},
        {"paper_window_px", paper_window_px, 101}}) {
    if (value > most)
      return Status::Error(std::string("dynamic.") + name + " must be at most " +
                           std::to_string(most));
  }
  if (!(paper_flow_px > 0) || paper_window_px < 3)
    return Status::Error("dynamic: paper_flow_px must be positive and paper_window_px at least 3");
  if (!(motion.min_residual_px > 0) || !(motion.look_back_s >= 0))
    return Status::Error(
        "dynamic.motion: min_residual_px must be positive, look_back_s not negative");
  if (!(mask.depth_band_m > 0) || !(mask.max_image_share > 0) || !(mask.max_mover_share > 0)) {
    return Status::Error(
        "dynamic.mask: depth_band_m, max_image_share and max_mover_share must be positive");
  }
  if (history_s < motion.look_back_s)
    return Status::Error("dynamic.history_s must be at least motion.look_back_s");
  if (!(max_feature_factor >= 1))
    return Status::Error("dynamic.max_feature_factor must be at least 1");
  return flow.Check();
}

}  // namespace msf
