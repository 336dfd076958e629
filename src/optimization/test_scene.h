// A random scene seen by a ring of cameras, for the tests and benchmarks of the solvers.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "optimization/bundle_adjustment.h"
#include "optimization/pose_optimizer.h"

namespace msf {

inline Camera TestCamera() { return *Camera::Preset("simulated"); }

struct TestSceneOptions {
  int num_poses = 10;
  int num_points = 300;
  int window = 10;        // a point is looked for in this many neighbouring poses
  double noise_px = 0.5;  // of u and v
  double disparity_noise_px = 0.1;
  double depth_share = 0.9;  // of the observations that have depth
  double outlier_share = 0;  // of the observations
  double travel_m = 1;       // length of the camera path
  unsigned seed = 1;
};

// Truth and noisy observations; `problem` holds the true poses and points.
inline BundleProblem MakeTestProblem(const Camera& camera, const TestSceneOptions& options,
                                     std::vector<uint8_t>* is_outlier = nullptr) {
  std::mt19937 random(options.seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 1);
  BundleProblem problem;
  for (int i = 0; i < options.num_poses; ++i) {
    const double s = options.num_poses > 1 ? i / (options.num_poses - 1.0) - 0.5 : 0;
    Vector6d twist;
    twist << s * options.travel_m, 0.1 * std::sin(5 * s), 0.1 * std::cos(7 * s),
        0.05 * std::sin(9 * s), 0.1 * s, 0.1 * std::cos(4 * s);
    problem.poses.push_back({Rigid3d::Exp(twist)});
  }
  for (int i = 0; i < options.num_points; ++i) {
    // Before the pose in the middle of the point's window.
    const int centre = static_cast<int>(uniform(random) * options.num_poses);
    const Eigen::Vector2d uv_px(uniform(random) * camera.width, uniform(random) * camera.height);
    const Eigen::Vector3d p_c = camera.Unproject(uv_px, 0.8 + 3 * uniform(random));
    problem.points.push_back({problem.poses[centre].T_cw.Inverse() * p_c});
    for (int j = std::max(0, centre - options.window / 2);
         j <= std::min(options.num_poses - 1, centre + options.window / 2); ++j) {
      const Eigen::Vector3d p_j = problem.poses[j].T_cw * problem.points.back().p_w;
      if (p_j.z() < 0.3) continue;
      Eigen::Vector2d seen_px = camera.Project(p_j);
      if (seen_px.x() < 0 || seen_px.y() < 0 || seen_px.x() >= camera.width ||
          seen_px.y() >= camera.height)
        continue;
      seen_px += options.noise_px * Eigen::Vector2d(normal(random), normal(random));
      BundleObservation observation;
      observation.pose = j;
      observation.point = i;
      observation.inv_sigma2 = 1 / std::max(options.noise_px * options.noise_px, 1e-4);
      observation.inv_sigma2_disparity =
          1 / std::max(options.disparity_noise_px * options.disparity_noise_px, 1e-4);
      const double disparity_noise_px = options.disparity_noise_px * normal(random);
      if (uniform(random) < options.depth_share)
        observation.disparity_px = camera.bf / p_j.z() + disparity_noise_px;
      const bool outlier = uniform(random) < options.outlier_share;
      if (outlier) seen_px = {uniform(random) * camera.width, uniform(random) * camera.height};
      observation.uv_px = seen_px;
      problem.observations.push_back(observation);
      if (is_outlier != nullptr) is_outlier->push_back(outlier);
    }
  }
  return problem;
}

// Moves everything that is not fixed away from the truth.
inline void Perturb(BundleProblem& problem, double pose_sigma, double point_sigma_m,
                    unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  for (BundlePose& pose : problem.poses) {
    Vector6d twist;
    for (double& value : twist) value = pose_sigma * normal(random);
    if (!pose.fixed) pose.T_cw = Rigid3d::Exp(twist) * pose.T_cw;
  }
  for (BundlePoint& point : problem.points) {
    const Eigen::Vector3d step =
        point_sigma_m * Eigen::Vector3d(normal(random), normal(random), normal(random));
    if (!point.fixed) point.p_w += step;
  }
}

// The observations of one pose, with the points as known.
inline std::vector<PoseObservation> ObservationsOfPose(const BundleProblem& problem, int pose) {
  std::vector<PoseObservation> observations;
  for (const BundleObservation& observation : problem.observations) {
    if (observation.pose != pose) continue;
    PoseObservation seen;
    static_cast<ImageObservation&>(seen) = observation;
    seen.p_w = problem.points[observation.point].p_w;
    observations.push_back(seen);
  }
  return observations;
}

// Distance of two poses: metres plus radians.
inline double PoseError(const Rigid3d& a, const Rigid3d& b) {
  const Rigid3d difference = a * b.Inverse();
  return difference.translation().norm() + difference.Angle();
}

}  // namespace msf
