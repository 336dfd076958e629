#include "dynamic/dynamic_options.h"

#include <algorithm>
#include <array>

namespace msf {

Status DynamicOptions::Check() const {
  constexpr std::array kModes = {"off", "boxes", "paper", "full"};
  if (std::find(kModes.begin(), kModes.end(), mode) == kModes.end())
    return Status::Error("dynamic.mode: '" + mode +
                         "' is not known; known are: off, boxes, paper, full");
  if (!(paper_flow_px > 0) || paper_window_px < 3)
    return Status::Error("dynamic: paper_flow_px must be positive and paper_window_px at least 3");
  if (!(motion.min_residual_px > 0) || !(motion.look_back_s >= 0))
    return Status::Error(
        "dynamic.motion: min_residual_px must be positive, look_back_s not negative");
  if (!(mask.depth_band_m > 0) || !(mask.max_image_share > 0))
    return Status::Error("dynamic.mask: depth_band_m and max_image_share must be positive");
  if (history_frames < 2) return Status::Error("dynamic.history_frames must be at least 2");
  if (!(max_feature_factor >= 1))
    return Status::Error("dynamic.max_feature_factor must be at least 1");
  return flow.Check();
}

}  // namespace msf
