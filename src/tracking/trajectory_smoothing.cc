#include "tracking/trajectory_smoothing.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace msf {
namespace {

constexpr double kReachInWidths = 3;  // beyond, a frame's weight is below a hundredth
constexpr int kMinFrames = 5;         // a second degree fits three frames whatever their noise

// The frames around `i`, itself included, that are near enough in time and hang together with it.
struct Neighbourhood {
  size_t begin, end;
};

Neighbourhood Around(const std::vector<ResolvedFrame>& frames, size_t i, double reach_s) {
  const auto reachable = [&](size_t from, size_t to) {
    return AreNeighbours(frames[from], frames[to]) &&
           std::abs(frames[to].time_s - frames[i].time_s) <= reach_s;
  };
  Neighbourhood around{i, i + 1};
  while (around.begin > 0 && reachable(around.begin, around.begin - 1)) --around.begin;
  while (around.end < frames.size() && reachable(around.end - 1, around.end)) ++around.end;
  return around;
}

// What takes frame `i` to the place where the motion of its neighbours says it was.
Vector6d Correction(const std::vector<ResolvedFrame>& frames, size_t i, Neighbourhood around,
                    double width_s) {
  const Rigid3d T_iw = frames[i].T_wc->Inverse();
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 6> right = Eigen::Matrix<double, 3, 6>::Zero();
  for (size_t k = around.begin; k < around.end; ++k) {
    const double time = (frames[k].time_s - frames[i].time_s) / width_s;
    const double weight = std::exp(-0.5 * time * time);
    const Eigen::Vector3d powers(1, time, time * time);
    normal += weight * powers * powers.transpose();
    right += weight * powers * (T_iw * *frames[k].T_wc).Log().transpose();
  }
  return normal.ldlt().solve(right).row(0).transpose();
}

}  // namespace

std::vector<ResolvedFrame> SmoothTrajectory(const std::vector<ResolvedFrame>& frames,
                                            double width_s) {
  std::vector<ResolvedFrame> smooth = frames;
  if (width_s <= 0) return smooth;
  for (size_t i = 0; i < frames.size(); ++i) {
    if (!frames[i].T_wc) continue;
    const Neighbourhood around = Around(frames, i, kReachInWidths * width_s);
    if (around.end - around.begin < kMinFrames) continue;
    smooth[i].T_wc = *frames[i].T_wc * Rigid3d::Exp(Correction(frames, i, around, width_s));
  }
  return smooth;
}

}  // namespace msf
