#include "optimization/bundle_adjustment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "optimization/bundle_layout.h"
#include "optimization/schur_solver.h"

namespace msf {
namespace {

bool IsCancelled(const std::atomic<bool>* cancel) {
  return cancel != nullptr && cancel->load(std::memory_order_relaxed);
}

// What is being solved for, with the rotations as matrices because every observation needs one.
struct BundleState {
  std::vector<Rigid3d> T_cw;
  std::vector<Eigen::Matrix3d> R_cw;
  std::vector<Eigen::Vector3d> p_w;

  explicit BundleState(const BundleProblem& problem) {
    for (const BundlePose& pose : problem.poses) {
      T_cw.push_back(pose.T_cw);
      R_cw.push_back(pose.T_cw.RotationMatrix());
    }
    for (const BundlePoint& point : problem.points) p_w.push_back(point.p_w);
  }
  Eigen::Vector3d InCamera(int pose, int point) const {
    return R_cw[pose] * p_w[point] + T_cw[pose].translation();
  }
  void CopyTo(BundleProblem& problem) const {
    for (size_t i = 0; i < T_cw.size(); ++i) {
      if (!problem.poses[i].fixed) problem.poses[i].T_cw = T_cw[i];
    }
    for (size_t i = 0; i < p_w.size(); ++i) problem.points[i].p_w = p_w[i];
  }
  BundleState Moved(const BundleLayout& layout, const BundleStep& step) const {
    BundleState moved = *this;
    for (size_t pose = 0; pose < T_cw.size(); ++pose) {
      if (layout.slot[pose] < 0) continue;
      moved.T_cw[pose] =
          Rigid3d::Exp(step.poses.segment<6>(Eigen::Index{6} * layout.slot[pose])) * T_cw[pose];
      moved.R_cw[pose] = moved.T_cw[pose].RotationMatrix();
    }
    for (size_t point = 0; point < p_w.size(); ++point) moved.p_w[point] += step.points[point];
    return moved;
  }
};

// One minimisation over a fixed set of observations.
class BundlePass {
 public:
  BundlePass(const Camera& camera, const BundleProblem& problem, const std::vector<uint8_t>& active,
             bool robust, const BundleOptions& options)
      : camera_(camera),
        problem_(problem),
        layout_(problem, active),
        gates_{options.chi2_two, options.chi2_three},
        robust_(robust),
        options_(options) {}

  double Cost(const BundleState& state) const;
  // Moves `state` to the minimum; counts the iterations.
  void Minimize(int max_iterations, const std::atomic<bool>* cancel, BundleState& state,
                int& iterations) const;

 private:
  std::vector<uint8_t> FreePoints() const;
  void Linearize(const BundleState& state, BundleEquations& equations) const;
  void AddPoint(const BundleState& state, int point, BundleEquations& equations) const;

  const Camera& camera_;
  const BundleProblem& problem_;
  const BundleLayout layout_;
  const Chi2Gates gates_;
  const bool robust_;
  const BundleOptions& options_;
};

std::vector<uint8_t> BundlePass::FreePoints() const {
  std::vector<uint8_t> free(problem_.points.size());
  for (size_t point = 0; point < free.size(); ++point) {
    free[point] = !problem_.points[point].fixed && layout_.begin[point] < layout_.begin[point + 1];
  }
  return free;
}

double BundlePass::Cost(const BundleState& state) const {
  double cost = 0;
  for (const BundleLayout::Place& place : layout_.places) {
    const BundleObservation& observation = problem_.observations[place.observation];
    const Eigen::Vector3d p_c = state.InCamera(observation.pose, observation.point);
    const double chi2 = ResidualChi2(ReprojectionResidual(camera_, p_c, observation), observation);
    cost += ObservationCost(observation, chi2, gates_.For(observation), robust_);
  }
  return cost;
}

void BundlePass::Linearize(const BundleState& state, BundleEquations& equations) const {
  equations.pose_information.assign(layout_.num_free_poses, Matrix6d::Zero());
  equations.pose_gradient.assign(layout_.num_free_poses, Vector6d::Zero());
  equations.point_information.assign(problem_.points.size(), Eigen::Matrix3d::Zero());
  equations.point_gradient.assign(problem_.points.size(), Eigen::Vector3d::Zero());
  equations.cross.resize(layout_.places.size());
  const int num_points = static_cast<int>(problem_.points.size());
  for (int point = 0; point < num_points; ++point) AddPoint(state, point, equations);
}

// With the camera-frame point p = R x + t: dp/d(twist) = [I, -Hat(p)] and dp/dx = R, so every block
// follows from the pull on p.
void BundlePass::AddPoint(const BundleState& state, int point, BundleEquations& equations) const {
  for (int i = layout_.begin[point]; i < layout_.begin[point + 1]; ++i) {
    const auto [index, slot] = layout_.places[i];
    const BundleObservation& observation = problem_.observations[index];
    const Eigen::Matrix3d& R_cw = state.R_cw[observation.pose];
    const Eigen::Vector3d p_c = state.InCamera(observation.pose, point);
    const PointPull pull = PullOnPoint(camera_, p_c, observation, gates_.For(observation), robust_);
    const Eigen::Matrix3d information_R = pull.information * R_cw;
    equations.point_information[point].noalias() += R_cw.transpose() * information_R;
    equations.point_gradient[point].noalias() += R_cw.transpose() * pull.gradient;
    if (slot < 0) continue;
    const Eigen::Matrix3d hat = Hat(p_c);
    equations.cross[i].topRows<3>() = information_R;
    equations.cross[i].bottomRows<3>().noalias() = hat * information_R;
    const Eigen::Matrix3d rotation_part = hat * pull.information;
    Matrix6d& information = equations.pose_information[slot];
    information.topLeftCorner<3, 3>() += pull.information;
    information.bottomLeftCorner<3, 3>() += rotation_part;
    information.topRightCorner<3, 3>() += rotation_part.transpose();
    information.bottomRightCorner<3, 3>().noalias() -= rotation_part * hat;
    equations.pose_gradient[slot].head<3>() += pull.gradient;
    equations.pose_gradient[slot].tail<3>() += p_c.cross(pull.gradient);
  }
}

// Levenberg-Marquardt with the damping rule of Madsen, Nielsen, Tingleff, Methods for Non-Linear
// Least Squares Problems, 2004.
void BundlePass::Minimize(int max_iterations, const std::atomic<bool>* cancel, BundleState& state,
                          int& iterations) const {
  if (layout_.places.empty()) return;
  SchurSolver solver(layout_, FreePoints(), options_.max_dense_poses);
  BundleEquations equations;
  BundleStep step;
  double cost = Cost(state), damping = 1e-4, growth = 2;
  bool moved = true;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    if (IsCancelled(cancel)) return;
    if (moved) Linearize(state, equations);
    ++iterations;
    moved = false;
    if (solver.Solve(equations, damping, step)) {
      if (step.predicted_decrease <= 1e-12 * cost) return;
      BundleState candidate = state.Moved(layout_, step);
      const double decrease = cost - Cost(candidate);
      if (decrease > 0) {
        moved = true;
        state = std::move(candidate);
        cost -= decrease;
        damping *= std::max(1. / 3, 1 - std::pow(2 * decrease / step.predicted_decrease - 1, 3));
        growth = 2;
        if (decrease < options_.function_tolerance * cost) return;
      }
    }
    if (!moved) {
      damping *= growth;
      growth *= 2;
    }
  }
}

std::vector<uint8_t> UsableObservations(const BundleProblem& problem) {
  const int num_poses = static_cast<int>(problem.poses.size()),
            num_points = static_cast<int>(problem.points.size());
  std::vector<uint8_t> usable;
  for (const BundleObservation& observation : problem.observations) {
    MSF_CHECK(observation.pose >= 0 && observation.pose < num_poses,
              "an observation needs a pose of the problem");
    MSF_CHECK(observation.point >= 0 && observation.point < num_points,
              "an observation needs a point of the problem");
    usable.push_back(observation.Usable() && problem.points[observation.point].p_w.allFinite());
  }
  return usable;
}

// The usable observations within their gates.
std::vector<uint8_t> FindInliers(const Camera& camera, const BundleProblem& problem,
                                 const BundleState& state, const std::vector<uint8_t>& usable,
                                 const BundleOptions& options) {
  const Chi2Gates gates{options.chi2_two, options.chi2_three};
  std::vector<uint8_t> inlier = usable;
  for (size_t i = 0; i < usable.size(); ++i) {
    if (!usable[i]) continue;
    const BundleObservation& observation = problem.observations[i];
    const Eigen::Vector3d p_c = state.InCamera(observation.pose, observation.point);
    inlier[i] = ReprojectionChi2(camera, p_c, observation) <= gates.For(observation);
  }
  return inlier;
}

bool AllFinite(const BundleState& state) {
  for (const Eigen::Matrix3d& R_cw : state.R_cw)
    if (!R_cw.allFinite()) return false;
  return std::all_of(state.T_cw.begin(), state.T_cw.end(),
                     [](const Rigid3d& T) { return T.translation().allFinite(); });
}

std::string Summarize(const BundleProblem& problem, const BundleResult& result) {
  return fmt::format(
      "{} poses, {} points, {} of {} observations kept, {} iterations, cost {:.6g} to {:.6g}{}",
      problem.poses.size(), problem.points.size(),
      std::count(result.inlier.begin(), result.inlier.end(), 1), result.inlier.size(),
      result.iterations, result.initial_cost, result.final_cost,
      result.cancelled ? ", cancelled" : "");
}

}  // namespace

Status BundleOptions::Check() const {
  if (robust_iterations < 0 || final_iterations < 0)
    return Status::Error("bundle adjustment: iterations must not be negative");
  if (!(chi2_two > 0 && chi2_three > 0))
    return Status::Error("bundle adjustment: the chi2 gates must be positive");
  if (!(function_tolerance >= 0))
    return Status::Error("bundle adjustment: function_tolerance must not be negative");
  if (max_dense_poses < 0)
    return Status::Error("bundle adjustment: max_dense_poses must not be negative");
  return Status::Ok();
}

BundleResult SolveBundle(const Camera& camera, BundleProblem& problem, const BundleOptions& options,
                         const std::atomic<bool>* cancel) {
  BundleResult result;
  BundleState state(problem);
  MSF_CHECK(AllFinite(state), "bundle adjustment needs finite poses");
  const std::vector<uint8_t> usable = UsableObservations(problem);
  const BundlePass robust_pass(camera, problem, usable, /*robust=*/true, options);
  result.initial_cost = robust_pass.Cost(state);
  robust_pass.Minimize(options.robust_iterations, cancel, state, result.iterations);
  result.inlier = FindInliers(camera, problem, state, usable, options);
  const BundlePass final_pass(camera, problem, result.inlier, options.final_kernel, options);
  final_pass.Minimize(options.final_iterations, cancel, state, result.iterations);
  result.inlier = FindInliers(camera, problem, state, usable, options);
  result.final_cost =
      BundlePass(camera, problem, result.inlier, /*robust=*/false, options).Cost(state);
  result.cancelled = IsCancelled(cancel);
  result.usable = result.iterations > 0 && std::isfinite(result.final_cost);
  result.summary = Summarize(problem, result);
  if (result.usable) state.CopyTo(problem);
  return result;
}

}  // namespace msf
