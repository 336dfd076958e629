#include "tracking/tracking_options.h"

#include <cmath>

namespace msf {

Status TrackingOptions::Check() const {
  if (min_initial_points < 10)
    return Status::Error("tracking.min_initial_points must be at least 10");
  if (min_initial_depths < 0)
    return Status::Error("tracking.min_initial_depths must not be negative");
  if (!(close_depth_baselines > 0))
    return Status::Error("tracking.close_depth_baselines must be positive");
  for (const double radius : {motion_radius_px, local_radius_factor,
                              local_radius_factor_relocalized, local_radius_factor_refined}) {
    if (!(radius > 0)) return Status::Error("tracking: search radii must be positive");
  }
  if (max_local_keyframes < 1)
    return Status::Error("tracking.max_local_keyframes must be at least 1");
  if (max_neighbours < 0) return Status::Error("tracking.max_neighbours must not be negative");
  if (local_search_rounds < 1 || local_search_rounds > 10)
    return Status::Error("tracking.local_search_rounds must be from 1 to 10");
  if (!(recently_lost_s >= 0))
    return Status::Error("tracking.recently_lost_s must not be negative");
  if (!std::isfinite(hindsight.after_s) || hindsight.max_frames < 1) {
    return Status::Error("tracking.hindsight.after_s must be a number, max_frames at least 1");
  }
  for (const double width_s : {smoothing.position_s, smoothing.rotation_s}) {
    if (!(width_s >= 0 && width_s <= 1))
      return Status::Error("tracking.smoothing: widths must be from 0 to 1 s");
  }
  if (!(keyframe.hidden_exponent >= 0 && keyframe.hidden_exponent <= 100))
    return Status::Error("tracking.keyframe.hidden_exponent must be from 0 to 100");
  if (!(velocity_trend >= 0 && velocity_trend <= 1))
    return Status::Error("tracking.velocity_trend must be from 0 to 1");
  for (const double probability : {min_static_probability, readmit_probability,
                                   readmit_point_probability, landmark_probability}) {
    if (!(probability >= 0 && probability <= 1))
      return Status::Error("tracking: probabilities must be from 0 to 1");
  }
  if (!(landmark_age_s >= 0) || max_landmarks < 0) {
    return Status::Error("tracking.landmark_age_s and tracking.max_landmarks must not be negative");
  }
  if (!(keyframe.max_interval_s > 0))
    return Status::Error("tracking.keyframe.max_interval_s must be positive");
  return pose.Check();
}

}  // namespace msf
