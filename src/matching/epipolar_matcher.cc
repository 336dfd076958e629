#include "matching/epipolar_matcher.h"

#include <algorithm>
#include <climits>

namespace msf {
namespace {

Eigen::Matrix3d CalibrationMatrix(const Camera& camera) {
  Eigen::Matrix3d K;
  K << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
  return K;
}

// F with x_a^T F x_b = 0 (Hartley & Zisserman, Multiple View Geometry, eq. 9.12).
Eigen::Matrix3d FundamentalMatrix(const Rigid3d& T_ab, const Camera& camera) {
  const Eigen::Matrix3d K_inverse = CalibrationMatrix(camera).inverse();
  return K_inverse.transpose() * Hat(T_ab.translation()) * T_ab.RotationMatrix() * K_inverse;
}

}  // namespace

std::vector<std::pair<int, int>> MatchByEpipolarLine(const WordImage& a, const WordImage& b,
                                                     const Rigid3d& T_ab, const Camera& camera,
                                                     const ScaleLevels& levels,
                                                     const EpipolarMatchOptions& options) {
  const Eigen::Matrix3d F_ba = FundamentalMatrix(T_ab, camera).transpose();
  struct Owner {
    int feature = -1;
    int distance = INT_MAX;
  };
  std::vector<Owner> owner_of_b(b.features.size());
  ForEachCommonNode(
      a.words, b.words, [&](const std::vector<int>& of_a, const std::vector<int>& of_b) {
        for (const int i : of_a) {
          if (!a.usable[i]) continue;
          const Eigen::Vector3d line_b = F_ba * a.features.uv_px[i].cast<double>().homogeneous();
          Owner best;
          for (const int j : of_b) {
            if (!b.usable[j]) continue;
            const int distance =
                DescriptorDistance(a.features.descriptors[i], b.features.descriptors[j]);
            if (distance > options.max_distance || distance >= best.distance) continue;
            const double offset = line_b.dot(b.features.uv_px[j].cast<double>().homogeneous());
            const double squared_px = offset * offset / line_b.head<2>().squaredNorm();
            if (squared_px < options.max_chi2 * levels.sigma2(b.features.level[j]))
              best = {j, distance};
          }
          if (best.feature < 0) continue;
          Owner& owner = owner_of_b[best.feature];
          if (best.distance < owner.distance) owner = {i, best.distance};
        }
      });
  std::vector<std::pair<int, int>> pairs;
  for (int j = 0; j < b.features.size(); ++j) {
    if (owner_of_b[j].feature >= 0) pairs.emplace_back(owner_of_b[j].feature, j);
  }
  std::sort(pairs.begin(), pairs.end());
  return KeepConsistentRotations(pairs, a.features, b.features);
}

}  // namespace msf
