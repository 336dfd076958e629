#include "evaluation/trajectory_error.h"

#include <cmath>

#include "util/check.h"

namespace msf {
namespace {

Rigid3d Scaled(const Rigid3d& T, double scale) {
  return {T.rotation(), Eigen::Vector3d(scale * T.translation())};
}

void AddStretch(const PosePair& from, const PosePair& to, double scale, RelativeError& error) {
  const Rigid3d true_motion = from.true_T_wc.Inverse() * to.true_T_wc;
  const Rigid3d estimated_motion = Scaled(from.estimated_T_wc.Inverse() * to.estimated_T_wc, scale);
  const Rigid3d difference = true_motion.Inverse() * estimated_motion;
  error.translation_m.time_s.push_back(to.time_s);
  error.translation_m.value.push_back(difference.translation().norm());
  error.rotation_rad.time_s.push_back(to.time_s);
  error.rotation_rad.value.push_back(difference.Angle());
}

}  // namespace

std::optional<AbsoluteError> ComputeAbsoluteError(std::span<const PosePair> pairs,
                                                  ScaleEstimation scale) {
  std::vector<Eigen::Vector3d> estimated, truth;
  for (const PosePair& pair : pairs) {
    estimated.push_back(pair.estimated_T_wc.translation());
    truth.push_back(pair.true_T_wc.translation());
  }
  const std::optional<Similarity3d> alignment = AlignPoints(estimated, truth, scale);
  if (!alignment) return std::nullopt;
  AbsoluteError error{*alignment, {}};
  for (size_t i = 0; i < pairs.size(); ++i) {
    error.translation_m.time_s.push_back(pairs[i].time_s);
    error.translation_m.value.push_back((truth[i] - *alignment * estimated[i]).norm());
  }
  return error;
}

RelativeError ComputeRelativeErrorOverFrames(std::span<const PosePair> pairs, size_t num_frames,
                                             double scale) {
  MSF_CHECK(num_frames > 0, "a stretch has at least one frame");
  RelativeError error;
  for (size_t i = 0; i + num_frames < pairs.size(); ++i)
    AddStretch(pairs[i], pairs[i + num_frames], scale, error);
  return error;
}

RelativeError ComputeRelativeErrorOverTime(std::span<const PosePair> pairs, double duration_s,
                                           double scale) {
  MSF_CHECK(duration_s > 0, "a stretch takes time");
  RelativeError error;
  size_t j = 0;
  for (const PosePair& pair : pairs) {
    const double end_s = pair.time_s + duration_s;
    const auto distance_s = [&](size_t k) { return std::abs(pairs[k].time_s - end_s); };
    while (j + 1 < pairs.size() && distance_s(j + 1) <= distance_s(j)) ++j;
    if (distance_s(j) <= kMaxAssociationGap_s) AddStretch(pair, pairs[j], scale, error);
  }
  return error;
}

}  // namespace msf
