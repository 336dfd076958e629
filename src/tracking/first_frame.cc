#include "tracking/first_frame.h"

#include "feature/rolling_shutter.h"

namespace msf {
namespace {

// Each takes three quarters or more off what the pose still moves.
constexpr int kRounds = 5;

}  // namespace

FirstFrame SettleFirstFrame(const TrackingContext& context,
                            const std::vector<PointSnapshot>& points, const FrameFeatures& features,
                            const Rigid3d& T_cw, const Rigid3d& T_cw_next, double interval_s) {
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
  return first;
}

}  // namespace msf
