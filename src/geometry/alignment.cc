#include "geometry/alignment.h"

#include <Eigen/SVD>
#include <numeric>

#include "util/check.h"

namespace msf {
namespace {

Eigen::Vector3d Mean(std::span<const Eigen::Vector3d> points) {
  const Eigen::Vector3d sum =
      std::accumulate(points.begin(), points.end(), Eigen::Vector3d(0, 0, 0));
  return sum / static_cast<double>(points.size());
}

}  // namespace

std::optional<Similarity3d> AlignPoints(std::span<const Eigen::Vector3d> from,
                                        std::span<const Eigen::Vector3d> to,
                                        ScaleEstimation scale) {
  MSF_CHECK(from.size() == to.size(), "points come in pairs");
  constexpr size_t kFewestPoints = 3;
  if (from.size() < kFewestPoints) return std::nullopt;

  const Eigen::Vector3d from_mean = Mean(from), to_mean = Mean(to);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double from_variance = 0;
  for (size_t i = 0; i < from.size(); ++i) {
    const Eigen::Vector3d from_centred = from[i] - from_mean;
    covariance += (to[i] - to_mean) * from_centred.transpose();
    from_variance += from_centred.squaredNorm();
  }
  if (from_variance == 0) return std::nullopt;

  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  const bool mirrored = svd.matrixU().determinant() * svd.matrixV().determinant() < 0;
  const Eigen::Vector3d signs(1, 1, mirrored ? -1 : 1);
  const Eigen::Matrix3d rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  const double factor =
      scale == ScaleEstimation::kFree ? svd.singularValues().dot(signs) / from_variance : 1.0;
  if (!(factor > 0)) return std::nullopt;  // the targets coincide
  return Similarity3d{
      factor, Rigid3d(rotation, Eigen::Vector3d(to_mean - factor * (rotation * from_mean)))};
}

}  // namespace msf
