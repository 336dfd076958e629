// Poses and points at once: the map's geometry that agrees best with all observations.
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "geometry/rigid3d.h"
#include "optimization/reprojection.h"
#include "sensor/camera.h"
#include "util/status.h"

namespace msf {

struct BundlePose {
  Rigid3d T_cw;
  bool fixed = false;
};

struct BundlePoint {
  Eigen::Vector3d p_w = Eigen::Vector3d::Zero();
  bool fixed = false;
};

// Pose `pose` saw point `point` (indices into the problem's arrays).
struct BundleObservation : ImageObservation {
  int pose = -1;
  int point = -1;
};

struct BundleProblem {
  std::vector<BundlePose> poses;
  std::vector<BundlePoint> points;
  std::vector<BundleObservation> observations;
};

struct BundleOptions {
  int robust_iterations = 5;
  int final_iterations = 10;
  bool final_kernel = false;
  double chi2_two = 5.991;
  double chi2_three = 7.815;
  double function_tolerance = 1e-4;
  int max_dense_poses = 150;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("robust_iterations", robust_iterations,
          "iterations of the first pass, with Huber's kernel on all observations");
    visit("final_iterations", final_iterations,
          "iterations of the second pass, on the inliers of the first");
    visit("final_kernel", final_kernel, "keep Huber's kernel in the second pass");
    visit("chi2_two", chi2_two, "inlier gate of an observation without depth");
    visit("chi2_three", chi2_three, "inlier gate of an observation with depth");
    visit("function_tolerance", function_tolerance,
          "a pass ends when a step lowers the cost by less than this part of it");
    visit("max_dense_poses", max_dense_poses,
          "free poses up to which the camera system is factorised as a dense matrix");
  }
  Status Check() const;
};

struct BundleResult {
  bool usable =
      false;  // the problem holds a solution that is better than, or as good as, the start
  bool cancelled = false;  // stopped early; poses and points are the best so far
  std::vector<uint8_t>
      inlier;  // per observation: within its gate at the end; never for one with weight 0
  double initial_cost = 0;  // sum of weight * rho(chi^2) of the first pass
  double final_cost = 0;    // sum of weight * chi^2 over the inliers
  int iterations = 0;
  std::string summary;  // one line for the log
};

// Minimises the robust reprojection error over the poses and points that are not fixed, in place: a
// pass with Huber's kernel over all observations, then one over its inliers. Levenberg-Marquardt on
// the camera system that remains when the points are eliminated (Schur complement; Triggs et al.,
// Bundle Adjustment: A Modern Synthesis, 2000), with T <- Exp(d) T. Single-threaded and
// deterministic: equal input gives bit-equal output. `cancel` is looked at before every iteration.
BundleResult SolveBundle(const Camera& camera, BundleProblem& problem, const BundleOptions& options,
                         const std::atomic<bool>* cancel = nullptr);

}  // namespace msf
