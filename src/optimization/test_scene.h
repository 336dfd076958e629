// A random scene seen by a ring of cameras, for the tests and benchmarks of the solvers.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
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

// Poses along a gently winding path, all looking roughly the same way.
inline std::vector<BundlePose> MakeTestPath(const TestSceneOptions& options) {
  std::vector<BundlePose> poses;
  for (int i = 0; i < options.num_poses; ++i) {
    const double s = options.num_poses > 1 ? i / (options.num_poses - 1.0) - 0.5 : 0;
    Vector6d twist;
    twist << s * options.travel_m, 0.1 * std::sin(5 * s), 0.1 * std::cos(7 * s),
        0.05 * std::sin(9 * s), 0.1 * s, 0.1 * std::cos(4 * s);
    poses.push_back({Rigid3d::Exp(twist)});
  }
  return poses;
}

// Draws what a camera sees.
class TestSensor {
 public:
  TestSensor(const Camera& camera, const TestSceneOptions& options)
      : camera_(camera), options_(options), random_(options.seed) {}

  double Uniform() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  double Normal() { return normal_(random_); }
  Eigen::Vector2d AnyPixel() { return {Uniform() * camera_.width, Uniform() * camera_.height}; }
  // A point that camera T_cw sees at 0.8 to 3.8 m.
  Eigen::Vector3d AnyPoint(const Rigid3d& T_cw) {
    return T_cw.Inverse() * camera_.Unproject(AnyPixel(), 0.8 + 3 * Uniform());
  }
  // The observation of a camera-frame point with noise, or a wrong one. Nothing outside the image.
  std::optional<BundleObservation> Observe(const Eigen::Vector3d& p_c, bool outlier) {
    const Eigen::Vector2d uv_px = camera_.Project(p_c);
    if (p_c.z() < 0.3 || uv_px.x() < 0 || uv_px.y() < 0 || uv_px.x() >= camera_.width ||
        uv_px.y() >= camera_.height) {
      return std::nullopt;
    }
    BundleObservation observation;
    observation.uv_px =
        outlier ? AnyPixel() : uv_px + options_.noise_px * Eigen::Vector2d(Normal(), Normal());
    observation.inv_sigma2 = 1 / std::max(options_.noise_px * options_.noise_px, 1e-4);
    observation.inv_sigma2_disparity =
        1 / std::max(options_.disparity_noise_px * options_.disparity_noise_px, 1e-4);
    if (Uniform() < options_.depth_share) {
      observation.disparity_px = camera_.bf / p_c.z() + options_.disparity_noise_px * Normal();
    }
    return observation;
  }

 private:
  const Camera& camera_;
  const TestSceneOptions& options_;
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
};

// True poses and points with noisy observations. `is_outlier`, when asked for: per observation,
// whether it is a wrong one.
inline BundleProblem MakeTestProblem(const Camera& camera, const TestSceneOptions& options,
                                     std::vector<uint8_t>* is_outlier = nullptr) {
  TestSensor sensor(camera, options);
  BundleProblem problem;
  problem.poses = MakeTestPath(options);
  for (int i = 0; i < options.num_points; ++i) {
    const int centre = static_cast<int>(sensor.Uniform() * options.num_poses);
    problem.points.push_back({sensor.AnyPoint(problem.poses[centre].T_cw)});
    const int first = std::max(0, centre - options.window / 2);
    const int last = std::min(options.num_poses - 1, centre + options.window / 2);
    for (int j = first; j <= last; ++j) {
      const bool outlier = sensor.Uniform() < options.outlier_share;
      std::optional<BundleObservation> seen =
          sensor.Observe(problem.poses[j].T_cw * problem.points[i].p_w, outlier);
      if (!seen) continue;
      seen->pose = j;
      seen->point = i;
      problem.observations.push_back(*seen);
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
    PoseObservation seen{static_cast<const ImageObservation&>(observation)};
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
