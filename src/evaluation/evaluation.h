// Everything that is said about one estimated trajectory.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/trajectory_error.h"
#include "util/status.h"

namespace msf {

struct EvaluationOptions {
  ScaleEstimation scale = ScaleEstimation::kFixed;
  double max_gap_s = kMaxAssociationGap_s;
  // Frames that the system was given; without it there is no coverage.
  std::optional<size_t> num_input_frames = std::nullopt;
};

struct Evaluation {
  std::string name;
  size_t num_poses = 0;
  std::optional<size_t> num_input_frames;
  std::vector<PosePair> pairs;
  AbsoluteError absolute;
  RelativeError per_frame;
  RelativeError per_second;

  // Share of the input frames that have a pose, 0..1.
  std::optional<double> Coverage() const;
};

// Errors: too few poses have a true one, or the estimate does not move.
StatusOr<Evaluation> EvaluateTrajectory(const std::string& name, const Trajectory& truth,
                                        const Trajectory& estimate,
                                        const EvaluationOptions& options = {});

}  // namespace msf
