#include "loop_closing/loop_closing_options.h"

namespace msf {

Status PlaceVerificationOptions::Check() const {
  if (num_window_neighbours < 0 || num_checked_neighbours < 0)
    return Status::Error("loop_closing.verification: numbers of neighbours must not be negative");
  if (!(match_ratio > 0 && match_ratio <= 1))
    return Status::Error("loop_closing.verification.match_ratio must be in (0, 1]");
  if (!(guided_radius_px > 0 && tight_radius_px > 0))
    return Status::Error("loop_closing.verification: search radii must be positive");
  if (num_agreeing_keyframes < 1)
    return Status::Error("loop_closing.verification.num_agreeing_keyframes must be at least 1");
  return alignment.Check();
}

Status LoopClosingOptions::Check() const {
  if (min_keyframes < 2) return Status::Error("loop_closing.min_keyframes must be at least 2");
  if (num_candidates < 1) return Status::Error("loop_closing.num_candidates must be at least 1");
  if (strong_covisibility < 1)
    return Status::Error("loop_closing.strong_covisibility must be at least 1");
  if (!(fuse_radius_px > 0)) return Status::Error("loop_closing.fuse_radius_px must be positive");
  if (max_seam_keyframes < 1)
    return Status::Error("loop_closing.max_seam_keyframes must be at least 1");
  MSF_RETURN_IF_ERROR(verification.Check());
  MSF_RETURN_IF_ERROR(pose.Check());
  MSF_RETURN_IF_ERROR(pose_graph.Check());
  MSF_RETURN_IF_ERROR(weld.Check());
  return full_bundle.Check();
}

}  // namespace msf
