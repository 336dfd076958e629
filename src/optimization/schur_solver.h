// The linear step of bundle adjustment: eliminate the points, solve for the poses, substitute back.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <vector>

#include "geometry/rigid3d.h"
#include "optimization/bundle_layout.h"

namespace msf {

using Matrix63d = Eigen::Matrix<double, 6, 3>;

// Gauss-Newton equations [U W; W^T V] (dx_poses, dx_points) = -(g_poses, g_points) in blocks; poses
// by slot, cross blocks by place of the layout (undefined where the pose or the point is fixed).
struct BundleEquations {
  std::vector<Matrix6d> pose_information;
  std::vector<Vector6d> pose_gradient;
  std::vector<Eigen::Matrix3d> point_information;
  std::vector<Eigen::Vector3d> point_gradient;
  std::vector<Matrix63d> cross;
};

struct BundleStep {
  Eigen::VectorXd poses;                // 6 per slot
  std::vector<Eigen::Vector3d> points;  // zero for fixed points
  double predicted_decrease = 0;        // of the sum of squares, according to the equations
};

class SchurSolver {
 public:
  // `point_is_free`: per point, whether it is to be solved for. Up to `max_dense_poses` free poses
  // the camera system is dense, beyond it sparse.
  SchurSolver(const BundleLayout& layout, std::vector<uint8_t> point_is_free, int max_dense_poses);

  // The step of the equations with their diagonal multiplied by 1 + damping; false when they are
  // singular even so.
  bool Solve(const BundleEquations& equations, double damping, BundleStep& step);

 private:
  struct Block {
    int row, column;  // slots, row >= column
    Matrix6d value;
  };
  void FindBlocks();
  void SetUpSparse();
  void EliminatePoints(const BundleEquations& equations, double damping);
  bool SolveDense(Eigen::VectorXd& poses);
  bool SolveSparse(Eigen::VectorXd& poses);
  void SubstitutePoints(const BundleEquations& equations, double damping, BundleStep& step) const;

  const BundleLayout& layout_;
  const std::vector<uint8_t> point_is_free_;
  const int num_poses_;
  const bool dense_;
  std::vector<int> block_index_;  // num_poses_ x num_poses_, row by row: index into blocks_ or -1
  std::vector<Block> blocks_;     // lower triangle of the camera system, sorted by column and row
  Eigen::VectorXd right_side_;
  std::vector<Eigen::Matrix3d> point_covariance_;  // inverse of the damped information
  Eigen::MatrixXd dense_system_;
  Eigen::SparseMatrix<double> sparse_system_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> sparse_cholesky_;
};

}  // namespace msf
