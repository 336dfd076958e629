#include "optimization/pose_graph.h"

#include <ceres/autodiff_cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/product_manifold.h>
#include <ceres/solver.h>
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <array>
#include <memory>

#include "util/check.h"

namespace msf {
namespace {

// Quaternion (x, y, z, w), then translation.
using PoseParameters = std::array<double, 7>;
using PoseManifold =
    ceres::ProductManifold<ceres::EigenQuaternionManifold, ceres::EuclideanManifold<3>>;

PoseParameters ToParameters(const Rigid3d& pose) {
  const Eigen::Vector4d q = pose.rotation().coeffs();
  const Eigen::Vector3d& t = pose.translation();
  return {q[0], q[1], q[2], q[3], t[0], t[1], t[2]};
}

Rigid3d ToPose(const PoseParameters& parameters) {
  return {Eigen::Quaterniond(parameters.data()), Eigen::Vector3d(parameters.data() + 4)};
}

class RelativePoseError {
 public:
  explicit RelativePoseError(const PoseGraphEdge& edge)
      : T_ba_measured_(edge.T_ab.Inverse()), sqrt_information_(edge.information.llt().matrixU()) {}

  template <typename T>
  bool operator()(const T* a, const T* b, T* error) const {
    const Eigen::Map<const Eigen::Quaternion<T>> q_aw(a), q_bw(b);
    const Eigen::Map<const Eigen::Matrix<T, 3, 1>> t_aw(a + 4), t_bw(b + 4);
    const Eigen::Quaternion<T> q_ab = q_aw * q_bw.conjugate();
    const Eigen::Matrix<T, 3, 1> t_ab = t_aw - q_ab * t_bw;
    const Eigen::Quaternion<T> q_ba = T_ba_measured_.rotation().cast<T>();
    const Eigen::Quaternion<T> q_error = q_ba * q_ab;
    Eigen::Matrix<T, 6, 1> e;
    e.template head<3>() = q_ba * t_ab + T_ba_measured_.translation().cast<T>();
    // q and -q are the same rotation; the short way round counts.
    e.template tail<3>() = T(q_error.w() < T(0) ? -2 : 2) * q_error.vec();
    Eigen::Map<Eigen::Matrix<T, 6, 1>>{error} = sqrt_information_.template cast<T>() * e;
    return true;
  }

 private:
  Rigid3d T_ba_measured_;
  Matrix6d sqrt_information_;
};

ceres::Solver::Options SolverOptions(const PoseGraphOptions& options) {
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = options.function_tolerance;
  solver.num_threads = 1;
  solver.logging_type = ceres::SILENT;
  return solver;
}

ceres::Problem::Options KeepOwnership() {
  ceres::Problem::Options options;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  return options;
}

}  // namespace

Status PoseGraphOptions::Check() const {
  if (max_iterations < 1) return Status::Error("pose graph: max_iterations must be at least 1");
  if (!(function_tolerance >= 0))
    return Status::Error("pose graph: function_tolerance must not be negative");
  if (!(huber_width >= 0)) return Status::Error("pose graph: huber_width must not be negative");
  return Status::Ok();
}

PoseGraphResult SolvePoseGraph(PoseGraph& graph, const PoseGraphOptions& options) {
  const int num_nodes = static_cast<int>(graph.nodes.size());
  std::vector<PoseParameters> poses;
  for (const PoseGraphNode& node : graph.nodes) poses.push_back(ToParameters(node.T_cw));

  PoseManifold manifold;
  const std::unique_ptr<ceres::LossFunction> kernel(
      options.huber_width > 0 ? new ceres::HuberLoss(options.huber_width) : nullptr);
  ceres::Problem problem(KeepOwnership());
  for (const PoseGraphEdge& edge : graph.edges) {
    MSF_CHECK(
        edge.a >= 0 && edge.a < num_nodes && edge.b >= 0 && edge.b < num_nodes && edge.a != edge.b,
        "an edge joins two nodes of the graph");
    if (graph.nodes[edge.a].fixed && graph.nodes[edge.b].fixed) continue;
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<RelativePoseError, 6, 7, 7>(new RelativePoseError(edge)),
        kernel.get(), poses[edge.a].data(), poses[edge.b].data());
  }
  for (int i = 0; i < num_nodes; ++i) {
    if (!problem.HasParameterBlock(poses[i].data())) continue;
    problem.SetManifold(poses[i].data(), &manifold);
    if (graph.nodes[i].fixed) problem.SetParameterBlockConstant(poses[i].data());
  }

  ceres::Solver::Summary summary;
  ceres::Solve(SolverOptions(options), &problem, &summary);
  PoseGraphResult result;
  result.usable = summary.IsSolutionUsable();
  result.initial_cost = 2 * summary.initial_cost;
  result.final_cost = 2 * summary.final_cost;
  result.iterations = static_cast<int>(summary.iterations.size());
  result.summary =
      fmt::format("{} nodes, {} edges, {} iterations, cost {:.6g} to {:.6g}", num_nodes,
                  graph.edges.size(), result.iterations, result.initial_cost, result.final_cost);
  if (!result.usable) return result;
  for (int i = 0; i < num_nodes; ++i) {
    if (!graph.nodes[i].fixed) graph.nodes[i].T_cw = ToPose(poses[i]);
  }
  return result;
}

}  // namespace msf
