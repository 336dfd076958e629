#include "training/least_squares.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>

namespace msf {

namespace {

using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Eigen::MatrixXd ToEigen(const torch::Tensor& tensor) {
  const torch::Tensor dense = tensor.to(torch::kFloat).contiguous();
  return Eigen::Map<const RowMajor>(dense.data_ptr<float>(), dense.size(0), dense.size(1))
      .cast<double>();
}

torch::Tensor ToTensor(const Eigen::MatrixXd& matrix) {
  torch::Tensor tensor = torch::empty({matrix.rows(), matrix.cols()}, torch::kFloat);
  Eigen::Map<RowMajor>(tensor.data_ptr<float>(), matrix.rows(), matrix.cols()) =
      matrix.cast<float>();
  return tensor;
}

}  // namespace

torch::Tensor PixelRows(const torch::Tensor& map, int64_t most) {
  const torch::Tensor rows = map.permute({0, 2, 3, 1}).reshape({-1, map.size(1)}).to(torch::kFloat);
  const int64_t step = std::max<int64_t>(1, rows.size(0) / most);
  // An odd step does not keep hitting the same columns.
  return rows.slice(0, 0, rows.size(0), step + (step % 2 == 0 ? 1 : 0)).contiguous();
}

torch::Tensor SolveLeastSquares(const torch::Tensor& features, const torch::Tensor& targets) {
  constexpr double kRidge = 1e-3;
  Eigen::MatrixXd gram = ToEigen(features.t().mm(features));
  const Eigen::MatrixXd right = ToEigen(features.t().mm(targets));
  gram.diagonal().array() += kRidge * gram.diagonal().mean();
  return ToTensor(gram.ldlt().solve(right));
}

torch::Tensor LeadingEigenvectors(const torch::Tensor& symmetric, int64_t count) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(ToEigen(symmetric));
  return ToTensor(solver.eigenvectors().rightCols(count));  // eigenvalues rise
}

}  // namespace msf
