// The two errors of trajectories that the field prints (Sturm et al., IROS 2012): absolute (ATE)
// and relative (RPE).
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "evaluation/association.h"
#include "geometry/alignment.h"

namespace msf {

// Errors over time; both lists have the same length.
struct ErrorSeries {
  std::vector<double> time_s;
  std::vector<double> value;
};

struct AbsoluteError {
  Similarity3d T_true_estimated;  // takes the estimate's world to the true one
  ErrorSeries translation_m;      // distance of the positions that is left after the alignment
};

// Aligns the estimated to the true positions (Umeyama) and measures what distance is left, for
// every pair. Nothing when the pairs are fewer than three or the estimate stays in one place.
std::optional<AbsoluteError> ComputeAbsoluteError(std::span<const PosePair> pairs,
                                                  ScaleEstimation scale = ScaleEstimation::kFixed);

// Drift over a stretch: E_i = (Q_i^-1 Q_j)^-1 (P_i^-1 P_j) with true poses Q and estimated poses P,
// at the time of j.
struct RelativeError {
  ErrorSeries translation_m;
  ErrorSeries rotation_rad;
};

// All stretches of `num_frames` successive pairs. `scale` multiplies the estimated positions.
RelativeError ComputeRelativeErrorOverFrames(std::span<const PosePair> pairs, size_t num_frames,
                                             double scale = 1);

// All stretches of `duration_s`: from each pair to the one nearest to that much later, if it is at
// most a twentieth off.
RelativeError ComputeRelativeErrorOverTime(std::span<const PosePair> pairs, double duration_s,
                                           double scale = 1);

}  // namespace msf
