#include "tracking/trajectory_smoothing.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace msf {
namespace {

constexpr double kReachInWidths = 3;  // beyond, a frame's weight is below a hundredth
constexpr int kNumPowers = 5;         // a fourth degree
constexpr size_t kMinFrames = 7;      // five would be met exactly, noise and all

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

// How far the motion of its neighbours leads away from the pose of frame `i`, where `difference`
// says how far another pose is from it; zero with a width of 0 or too few neighbours.
template <typename Difference>
Eigen::Vector3d Correction(const std::vector<ResolvedFrame>& frames, size_t i, double width_s,
                           const Difference& difference) {
  if (width_s <= 0) return Eigen::Vector3d::Zero();
  const Neighbourhood around = Around(frames, i, kReachInWidths * width_s);
  if (around.end - around.begin < kMinFrames) return Eigen::Vector3d::Zero();
  Eigen::Matrix<double, kNumPowers, kNumPowers> normal =
      Eigen::Matrix<double, kNumPowers, kNumPowers>::Zero();
  Eigen::Matrix<double, kNumPowers, 3> right = Eigen::Matrix<double, kNumPowers, 3>::Zero();
  for (size_t k = around.begin; k < around.end; ++k) {
    const double time = (frames[k].time_s - frames[i].time_s) / width_s;
    const double weight = std::exp(-0.5 * time * time);
    Eigen::Matrix<double, kNumPowers, 1> powers;
    powers(0) = 1;
    for (int p = 1; p < kNumPowers; ++p) powers(p) = powers(p - 1) * time;
    normal += weight * powers * powers.transpose();
    right += weight * powers * difference(*frames[k].T_wc).transpose();
  }
  return normal.ldlt().solve(right).row(0).transpose();
}

}  // namespace

std::vector<ResolvedFrame> SmoothTrajectory(const std::vector<ResolvedFrame>& frames,
                                            const SmoothingOptions& options) {
  std::vector<ResolvedFrame> smooth = frames;
  for (size_t i = 0; i < frames.size(); ++i) {
    if (!frames[i].T_wc) continue;
    const Rigid3d& T_wi = *frames[i].T_wc;
    const Eigen::Vector3d shift =
        Correction(frames, i, options.position_s, [&](const Rigid3d& T_wk) -> Eigen::Vector3d {
          return T_wk.translation() - T_wi.translation();
        });
    const Eigen::Vector3d turn =
        Correction(frames, i, options.rotation_s, [&](const Rigid3d& T_wk) {
          return LogRotation(T_wi.rotation().conjugate() * T_wk.rotation());
        });
    smooth[i].T_wc = Rigid3d(T_wi.rotation() * ExpRotation(turn), T_wi.translation() + shift);
  }
  return smooth;
}

}  // namespace msf
