#include "tracking/first_frame.h"

#include <algorithm>

#include "feature/rolling_shutter.h"

namespace msf {
namespace {

// Each takes three quarters or more off what the pose still moves.
constexpr int kRounds = 5;

// Mean shift of the features, px. Poses that are off by 2 to 3 mm and 0.2 degrees give a velocity
// that shifts them by about half of this.
constexpr double kLeastBend_px = 1;

double MeanShift(const FrameFeatures& a, const FrameFeatures& b) {
  double sum_px = 0;
  for (int i = 0; i < a.size(); ++i) sum_px += (a.uv_px[i] - b.uv_px[i]).norm();
  return sum_px / std::max(1, a.size());
}

}  // namespace

std::optional<FirstFrame> SettleFirstFrame(const TrackingContext& context,
                                           const std::vector<PointSnapshot>& points,
                                           const FrameFeatures& features, const Rigid3d& T_cw,
                                           const Rigid3d& T_cw_next, double interval_s) {
  FirstFrame first{.features = nullptr, .T_cw = T_cw, .matches = {}};
  for (int round = 0; round < kRounds; ++round) {
    const Vector6d velocity = (T_cw_next * first.T_cw.Inverse()).Log() / interval_s;
    first.features = std::make_shared<const FrameFeatures>(
        UndoRollingShutter(features, context.camera, velocity));
    first.matches = MatchLocalPoints(context, points, *first.features, first.T_cw, {},
                                     context.options.local_radius_factor_refined)
                        .matches;
    std::vector<PointMatch> agreeing = first.matches;
    OptimizeFramePose(context, *first.features, context.options.min_local_inliers, agreeing,
                      first.T_cw);
  }
  if (MeanShift(features, *first.features) < kLeastBend_px) return std::nullopt;
  return first;
}

}  // namespace msf
