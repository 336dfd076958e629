#include "optimization/pose_optimizer.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace msf {
namespace {

// The cost and its quadratic model around one pose.
struct NormalEquations {
  Matrix6d information = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  double cost = 0;
};

class PoseProblem {
 public:
  PoseProblem(const Camera& camera, std::span<const PoseObservation> observations,
              const PoseOptimizerOptions& options)
      : camera_(camera),
        observations_(observations),
        gates_{options.chi2_two, options.chi2_three},
        options_(options),
        usable_(observations.size()) {
    for (size_t i = 0; i < observations.size(); ++i) {
      usable_[i] = observations[i].Usable() && observations[i].p_w.allFinite();
    }
    active_ = usable_;
  }

  // Marks the observations within their gates as active; says whether that changed any, and counts
  // them.
  bool Reclassify(const Rigid3d& T_cw);
  int num_active() const { return static_cast<int>(std::count(active_.begin(), active_.end(), 1)); }
  const std::vector<uint8_t>& active() const { return active_; }

  NormalEquations Linearize(const Rigid3d& T_cw, bool robust) const;
  // Levenberg-Marquardt from T_cw over the active observations.
  Rigid3d Minimize(Rigid3d T_cw, bool robust) const;

 private:
  const Camera& camera_;
  std::span<const PoseObservation> observations_;
  Chi2Gates gates_;
  const PoseOptimizerOptions& options_;
  std::vector<uint8_t> usable_;
  std::vector<uint8_t> active_;
};

bool PoseProblem::Reclassify(const Rigid3d& T_cw) {
  const Eigen::Matrix3d R_cw = T_cw.RotationMatrix();
  bool changed = false;
  for (size_t i = 0; i < observations_.size(); ++i) {
    if (!usable_[i]) continue;
    const PoseObservation& observation = observations_[i];
    const Eigen::Vector3d p_c = R_cw * observation.p_w + T_cw.translation();
    const uint8_t active = ReprojectionChi2(camera_, p_c, observation) <= gates_.For(observation);
    changed |= active != active_[i];
    active_[i] = active;
  }
  return changed;
}

// Adds the pull on a camera-frame point p to the equations of the twist: dp/d(twist) = [I,
// -Hat(p)].
void AddPull(const Eigen::Vector3d& p_c, const PointPull& pull, NormalEquations& equations) {
  const Eigen::Matrix3d hat = Hat(p_c);
  const Eigen::Matrix3d rotation_part = hat * pull.information;
  equations.cost += pull.cost;
  equations.information.topLeftCorner<3, 3>() += pull.information;
  equations.information.bottomLeftCorner<3, 3>() += rotation_part;
  equations.information.bottomRightCorner<3, 3>() -= rotation_part * hat;
  equations.gradient.head<3>() += pull.gradient;
  equations.gradient.tail<3>() += p_c.cross(pull.gradient);
}

NormalEquations PoseProblem::Linearize(const Rigid3d& T_cw, bool robust) const {
  const Eigen::Matrix3d R_cw = T_cw.RotationMatrix();
  NormalEquations equations;
  for (size_t i = 0; i < observations_.size(); ++i) {
    if (!active_[i]) continue;
    const PoseObservation& observation = observations_[i];
    const Eigen::Vector3d p_c = R_cw * observation.p_w + T_cw.translation();
    AddPull(p_c, PullOnPoint(camera_, p_c, observation, gates_.For(observation), robust),
            equations);
  }
  equations.information.topRightCorner<3, 3>() =
      equations.information.bottomLeftCorner<3, 3>().transpose();
  return equations;
}

Rigid3d PoseProblem::Minimize(Rigid3d T_cw, bool robust) const {
  double damping = 1e-6;
  NormalEquations equations = Linearize(T_cw, robust);
  for (int iteration = 0; iteration < options_.max_iterations; ++iteration) {
    Matrix6d damped = equations.information;
    damped.diagonal() += damping * (equations.information.diagonal().array() + 1e-9).matrix();
    const Vector6d step = -damped.ldlt().solve(equations.gradient);
    if (!step.allFinite()) break;
    const Rigid3d T_candidate = Rigid3d::Exp(step) * T_cw;
    const NormalEquations candidate = Linearize(T_candidate, robust);
    if (candidate.cost < equations.cost) {
      T_cw = T_candidate;
      equations = candidate;
      damping = std::max(damping * 0.1, 1e-9);
    } else {
      damping = std::max(damping * 100, 1e-3);
    }
    if (step.norm() < options_.step_tolerance) break;
  }
  return T_cw;
}

}  // namespace

Status PoseOptimizerOptions::Check() const {
  if (rounds < 1 || max_iterations < 1)
    return Status::Error("pose optimisation: rounds and max_iterations must be at least 1");
  if (robust_rounds < 0 || robust_rounds > rounds)
    return Status::Error("pose optimisation: robust_rounds must lie between 0 and rounds");
  if (!(chi2_two > 0 && chi2_three > 0))
    return Status::Error("pose optimisation: the chi2 gates must be positive");
  if (min_observations < 3)
    return Status::Error("pose optimisation: min_observations must be at least 3");
  if (!(step_tolerance >= 0))
    return Status::Error("pose optimisation: step_tolerance must not be negative");
  return Status::Ok();
}

PoseEstimate OptimizePose(const Camera& camera, const Rigid3d& T_cw_initial,
                          std::span<const PoseObservation> observations,
                          const PoseOptimizerOptions& options) {
  PoseEstimate estimate{.T_cw = T_cw_initial,
                        .inlier = std::vector<uint8_t>(observations.size(), 0)};
  PoseProblem problem(camera, observations, options);
  Rigid3d T_cw = T_cw_initial;
  const auto run_rounds = [&](int rounds, bool robust) {
    for (int round = 0; round < rounds && problem.num_active() >= options.min_observations;
         ++round) {
      T_cw = problem.Minimize(T_cw, robust);
      // With the same inliers as before, further rounds of the kind would repeat this one.
      if (!problem.Reclassify(T_cw)) return;
    }
  };
  run_rounds(options.robust_rounds, /*robust=*/true);
  run_rounds(options.rounds - options.robust_rounds, /*robust=*/false);
  if (problem.num_active() < options.min_observations) return estimate;
  estimate.T_cw = T_cw;
  estimate.inlier = problem.active();
  estimate.num_inliers = problem.num_active();
  return estimate;
}

}  // namespace msf
