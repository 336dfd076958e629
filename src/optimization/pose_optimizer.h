// The pose of one camera from points whose places in the world are known (motion-only bundle
// adjustment).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/rigid3d.h"
#include "optimization/reprojection.h"
#include "sensor/camera.h"
#include "util/status.h"

namespace msf {

// A world point and where the camera saw it.
struct PoseObservation : ImageObservation {
  Eigen::Vector3d p_w = Eigen::Vector3d::Zero();
};

struct PoseOptimizerOptions {
  int rounds = 4;
  int robust_rounds = 2;
  int max_iterations = 10;
  double chi2_two = 5.991;
  double chi2_three = 7.815;
  int min_observations = 4;
  double step_tolerance = 1e-6;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("rounds", rounds, "rounds of optimisation, each followed by a new choice of inliers");
    visit("robust_rounds", robust_rounds, "of these, the first rounds that use Huber's kernel");
    visit("max_iterations", max_iterations, "iterations per round");
    visit("chi2_two", chi2_two, "inlier gate of an observation without depth");
    visit("chi2_three", chi2_three, "inlier gate of an observation with depth");
    visit("min_observations", min_observations, "inliers without which there is no pose");
    visit("step_tolerance", step_tolerance, "a round ends when a step (m, rad) is shorter");
  }
  Status Check() const;
};

struct PoseEstimate {
  Rigid3d T_cw;
  std::vector<uint8_t>
      inlier;           // per observation: within its gate at T_cw; never for one with weight 0
  int num_inliers = 0;  // 0: no pose could be found, T_cw is the initial one
};

// Minimises sum_i weight_i rho(r_i^T W_i r_i) over T_cw by Levenberg-Marquardt with T <- Exp(d) T.
// Rounds of at most `max_iterations`; after each the inliers are chosen anew among all
// observations; Huber's kernel in the first rounds only. Observations that are not Usable() or
// whose point lies behind the camera are outliers.
PoseEstimate OptimizePose(const Camera& camera, const Rigid3d& T_cw_initial,
                          std::span<const PoseObservation> observations,
                          const PoseOptimizerOptions& options);

}  // namespace msf
