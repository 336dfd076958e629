// The same bundle problem solved by Ceres: the reference that SolveBundle has to agree with and its
// benchmark is held against.
#pragma once

#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/sized_cost_function.h>
#include <ceres/solver.h>

#include <array>
#include <vector>

#include "optimization/bundle_adjustment.h"

namespace msf {

// Quaternion (x, y, z, w) and translation, moved by T <- Exp(d) T. Only the tangent space is ever
// looked at: cost functions hand out derivatives by d in the first six columns, which the identity
// on top of PlusJacobian passes on.
class TestPoseManifold : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }
  static Rigid3d ToPose(const double* x) {
    return {Eigen::Quaterniond(x), Eigen::Vector3d(x[4], x[5], x[6])};
  }
  static std::array<double, 7> FromPose(const Rigid3d& T) {
    const Eigen::Vector4d q = T.rotation().coeffs();
    const Eigen::Vector3d& t = T.translation();
    return {q[0], q[1], q[2], q[3], t[0], t[1], t[2]};
  }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    const std::array<double, 7> moved =
        FromPose(Rigid3d::Exp(Eigen::Map<const Vector6d>(delta)) * ToPose(x));
    std::copy(moved.begin(), moved.end(), x_plus_delta);
    return true;
  }
  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>>(jacobian).setIdentity();
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    Eigen::Map<Vector6d>{y_minus_x} = (ToPose(y) * ToPose(x).Inverse()).Log();
    return true;
  }
  bool MinusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>>(jacobian).setIdentity();
    return true;
  }
};

class TestReprojectionCost : public ceres::SizedCostFunction<3, 7, 3> {
 public:
  TestReprojectionCost(const Camera& camera, const ImageObservation& observation)
      : camera_(camera),
        observation_(observation),
        scale_(Eigen::Vector3d(observation.inv_sigma2, observation.inv_sigma2,
                               observation.inv_sigma2_disparity)
                   .cwiseSqrt()) {}

  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override {
    const Rigid3d T_cw = TestPoseManifold::ToPose(parameters[0]);
    const Eigen::Vector3d p_c = T_cw * Eigen::Map<const Eigen::Vector3d>(parameters[1]);
    Eigen::Map<Eigen::Vector3d>{residuals} =
        scale_.cwiseProduct(ReprojectionResidual(camera_, p_c, observation_));
    if (jacobians == nullptr) return true;
    Eigen::Matrix3d by_point_c = scale_.asDiagonal() * ReprojectionJacobian(camera_, p_c).Matrix();
    if (!observation_.HasDepth()) by_point_c.row(2).setZero();
    if (jacobians[0] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 3, 7, Eigen::RowMajor>> by_pose(jacobians[0]);
      by_pose << by_point_c, -by_point_c * Hat(p_c), Eigen::Vector3d::Zero();
    }
    if (jacobians[1] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>{jacobians[1]} =
          by_point_c * T_cw.RotationMatrix();
    }
    return true;
  }

 private:
  const Camera& camera_;
  ImageObservation observation_;
  Eigen::Vector3d scale_;
};

// One minimisation over all observations, with Huber's kernel or without, in place. Returns the
// cost in SolveBundle's measure.
inline double SolveBundleWithCeres(const Camera& camera, BundleProblem& problem,
                                   const BundleOptions& options, bool robust, int max_iterations) {
  std::vector<std::array<double, 7>> poses;
  for (const BundlePose& pose : problem.poses)
    poses.push_back(TestPoseManifold::FromPose(pose.T_cw));
  ceres::Problem ceres_problem;
  auto* ordering = new ceres::ParameterBlockOrdering;
  for (const BundleObservation& observation : problem.observations) {
    const double gate = observation.HasDepth() ? options.chi2_three : options.chi2_two;
    ceres::LossFunction* kernel = robust ? new ceres::HuberLoss(std::sqrt(gate)) : nullptr;
    ceres_problem.AddResidualBlock(
        new TestReprojectionCost(camera, observation),
        new ceres::ScaledLoss(kernel, observation.weight, ceres::TAKE_OWNERSHIP),
        poses[observation.pose].data(), problem.points[observation.point].p_w.data());
  }
  for (size_t i = 0; i < poses.size(); ++i) {
    if (!ceres_problem.HasParameterBlock(poses[i].data())) continue;
    ceres_problem.SetManifold(poses[i].data(), new TestPoseManifold);
    if (problem.poses[i].fixed) ceres_problem.SetParameterBlockConstant(poses[i].data());
    ordering->AddElementToGroup(poses[i].data(), 1);
  }
  for (BundlePoint& point : problem.points) {
    if (!ceres_problem.HasParameterBlock(point.p_w.data())) continue;
    if (point.fixed) ceres_problem.SetParameterBlockConstant(point.p_w.data());
    ordering->AddElementToGroup(point.p_w.data(), 0);
  }
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_SCHUR;
  solver.linear_solver_ordering.reset(ordering);
  solver.max_num_iterations = max_iterations;
  solver.function_tolerance = options.function_tolerance;
  solver.parameter_tolerance = solver.gradient_tolerance = 0;
  solver.num_threads = 1;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &ceres_problem, &summary);
  for (size_t i = 0; i < poses.size(); ++i)
    problem.poses[i].T_cw = TestPoseManifold::ToPose(poses[i].data());
  return 2 * summary.final_cost;
}

}  // namespace msf
