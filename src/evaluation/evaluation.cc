#include "evaluation/evaluation.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace msf {

std::optional<double> Evaluation::Coverage() const {
  if (!num_input_frames || *num_input_frames == 0) return std::nullopt;
  return static_cast<double>(num_poses) / static_cast<double>(*num_input_frames);
}

StatusOr<Evaluation> EvaluateTrajectory(const std::string& name, const Trajectory& truth,
                                        const Trajectory& estimate,
                                        const EvaluationOptions& options) {
  constexpr size_t kFewestPairs = 3;
  Evaluation evaluation;
  evaluation.name = name;
  evaluation.num_poses = estimate.size();
  evaluation.num_input_frames = options.num_input_frames;
  evaluation.pairs = AssociateTrajectories(truth, estimate, options.max_gap_s);
  if (evaluation.pairs.size() < kFewestPairs) {
    return Status::Error(fmt::format(
        "{}: {} of {} poses have a true pose within {} s, an evaluation needs {}; do the time "
        "stamps "
        "belong to this ground truth?",
        name, evaluation.pairs.size(), estimate.size(), options.max_gap_s, kFewestPairs));
  }
  std::optional<AbsoluteError> absolute = ComputeAbsoluteError(evaluation.pairs, options.scale);
  if (!absolute)
    return Status::Error(name +
                         ": all positions coincide, so it cannot be aligned with the ground truth");
  evaluation.absolute = std::move(*absolute);
  const double scale = evaluation.absolute.T_true_estimated.scale;
  evaluation.per_frame = ComputeRelativeErrorOverFrames(evaluation.pairs, 1, scale);
  evaluation.per_second = ComputeRelativeErrorOverTime(evaluation.pairs, 1.0, scale);
  return evaluation;
}

}  // namespace msf
