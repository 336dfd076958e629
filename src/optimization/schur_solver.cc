#include "optimization/schur_solver.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>

#include "optimization/bundle_adjustment.h"

namespace msf {
namespace {

// Keeps a direction that no observation constrains solvable.
constexpr double kMinDiagonal = 1e-6;

template <typename Matrix>
Matrix Damped(const Matrix& information, double damping) {
  Matrix damped = information;
  damped.diagonal() += damping * information.diagonal().cwiseMax(kMinDiagonal);
  return damped;
}

template <typename Information, typename Gradient, typename Step>
double PredictedDecrease(const Information& information, const Gradient& gradient, const Step& step,
                         double damping) {
  return step.dot(damping * information.diagonal().cwiseMax(kMinDiagonal).cwiseProduct(step) -
                  gradient);
}

}  // namespace

SchurSolver::SchurSolver(const BundleLayout& layout, std::vector<uint8_t> point_is_free,
                         int max_dense_poses)
    : layout_(layout),
      point_is_free_(std::move(point_is_free)),
      num_poses_(layout.num_free_poses),
      dense_(num_poses_ <= max_dense_poses),
      right_side_(6 * num_poses_),
      point_covariance_(point_is_free_.size()) {
  FindBlocks();
  if (!dense_) SetUpSparse();
}

// A block of the camera system is filled when the two poses share a point.
void SchurSolver::FindBlocks() {
  std::vector<uint8_t> shared(static_cast<size_t>(num_poses_) * num_poses_, 0);
  for (int slot = 0; slot < num_poses_; ++slot) shared[slot * num_poses_ + slot] = 1;
  for (size_t point = 0; point < point_is_free_.size(); ++point) {
    if (!point_is_free_[point]) continue;
    for (int j = layout_.begin[point]; j < layout_.begin[point + 1]; ++j) {
      const int column = layout_.places[j].slot;
      if (column < 0) continue;
      for (int k = j; k < layout_.begin[point + 1]; ++k)
        shared[column * num_poses_ + layout_.places[k].slot] = 1;
    }
  }
  block_index_.assign(shared.size(), -1);
  for (int column = 0; column < num_poses_; ++column) {
    for (int row = column; row < num_poses_; ++row) {
      if (!shared[column * num_poses_ + row]) continue;
      block_index_[column * num_poses_ + row] = static_cast<int>(blocks_.size());
      blocks_.push_back({row, column, Matrix6d::Zero()});
    }
  }
}

bool SchurSolver::Solve(const BundleEquations& equations, double damping, BundleStep& step) {
  EliminatePoints(equations, damping);
  if (!(dense_ ? SolveDense(step.poses) : SolveSparse(step.poses))) return false;
  SubstitutePoints(equations, damping, step);
  return step.poses.allFinite() && std::isfinite(step.predicted_decrease);
}

// S = U - W V^-1 W^T and its right side -g_poses + W V^-1 g_points, point by point.
void SchurSolver::EliminatePoints(const BundleEquations& equations, double damping) {
  for (Block& block : blocks_) block.value.setZero();
  for (int slot = 0; slot < num_poses_; ++slot) {
    blocks_[block_index_[slot * num_poses_ + slot]].value =
        Damped(equations.pose_information[slot], damping);
    right_side_.segment<6>(6 * slot) = -equations.pose_gradient[slot];
  }
  for (size_t point = 0; point < point_is_free_.size(); ++point) {
    if (!point_is_free_[point]) continue;
    const Eigen::Matrix3d covariance =
        Damped(equations.point_information[point], damping).inverse();
    point_covariance_[point] = covariance;
    const int end = layout_.begin[point + 1];
    for (int j = layout_.begin[point]; j < end; ++j) {
      const int column = layout_.places[j].slot;
      if (column < 0) continue;
      const Matrix63d gain = equations.cross[j] * covariance;
      right_side_.segment<6>(6 * column) += gain * equations.point_gradient[point];
      const int* const column_blocks = &block_index_[static_cast<size_t>(column) * num_poses_];
      for (int k = j; k < end; ++k) {
        const int row = layout_.places[k].slot;
        Matrix6d& block = blocks_[column_blocks[row]].value;
        block.noalias() -= equations.cross[k] * gain.transpose();
        // A pose that sees a point twice: the mirrored product belongs to the same diagonal block.
        if (row == column && k != j) block.noalias() -= gain * equations.cross[k].transpose();
      }
    }
  }
}

bool SchurSolver::SolveDense(Eigen::VectorXd& poses) {
  dense_system_.setZero(6 * num_poses_, 6 * num_poses_);
  for (const Block& block : blocks_)
    dense_system_.block<6, 6>(6 * block.row, 6 * block.column) = block.value;
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> cholesky(dense_system_);  // in place
  if (cholesky.info() != Eigen::Success) return false;
  poses = cholesky.solve(right_side_);
  return true;
}

// The pattern never changes, so it is laid out and ordered once.
void SchurSolver::SetUpSparse() {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(36 * blocks_.size());
  for (const Block& block : blocks_) {
    for (int c = 0; c < 6; ++c) {
      for (int r = 0; r < 6; ++r)
        entries.emplace_back(6 * block.row + r, 6 * block.column + c, 1.0);
    }
  }
  sparse_system_.resize(6 * num_poses_, 6 * num_poses_);
  sparse_system_.setFromTriplets(entries.begin(), entries.end());
  sparse_cholesky_.analyzePattern(sparse_system_);
}

bool SchurSolver::SolveSparse(Eigen::VectorXd& poses) {
  // Compressed columns: the blocks of one block column lie below each other, in the order of
  // blocks_.
  double* values = sparse_system_.valuePtr();
  for (size_t first = 0; first < blocks_.size();) {
    size_t last = first;
    while (last < blocks_.size() && blocks_[last].column == blocks_[first].column) ++last;
    for (int c = 0; c < 6; ++c) {
      for (size_t i = first; i < last; ++i, values += 6)
        Eigen::Map<Vector6d>{values} = blocks_[i].value.col(c);
    }
    first = last;
  }
  sparse_cholesky_.factorize(sparse_system_);
  if (sparse_cholesky_.info() != Eigen::Success) return false;
  poses = sparse_cholesky_.solve(right_side_);
  return true;
}

void SchurSolver::SubstitutePoints(const BundleEquations& equations, double damping,
                                   BundleStep& step) const {
  step.predicted_decrease = 0;
  for (int slot = 0; slot < num_poses_; ++slot) {
    step.predicted_decrease +=
        PredictedDecrease(equations.pose_information[slot], equations.pose_gradient[slot],
                          step.poses.segment<6>(6 * slot), damping);
  }
  step.points.assign(point_is_free_.size(), Eigen::Vector3d::Zero());
  for (size_t point = 0; point < point_is_free_.size(); ++point) {
    if (!point_is_free_[point]) continue;
    Eigen::Vector3d right_side = -equations.point_gradient[point];
    for (int j = layout_.begin[point]; j < layout_.begin[point + 1]; ++j) {
      const int slot = layout_.places[j].slot;
      if (slot >= 0)
        right_side.noalias() -= equations.cross[j].transpose() * step.poses.segment<6>(6 * slot);
    }
    step.points[point] = point_covariance_[point] * right_side;
    step.predicted_decrease +=
        PredictedDecrease(equations.point_information[point], equations.point_gradient[point],
                          step.points[point], damping);
  }
}

}  // namespace msf
