#include "dynamic/camera_motion.h"

#include "estimation/pnp.h"

namespace msf {
namespace {

constexpr int kFewestInliers = 15;
constexpr double kFlowSigma_px = 0.5;

std::vector<PoseObservation> Observe(const Camera& camera, const ScaleLevels& levels,
                                     const FrameFeatures& features, std::span<const int> which,
                                     std::span<const FlowPoint> flow) {
  std::vector<PoseObservation> observations;
  for (size_t k = 0; k < which.size(); ++k) {
    const int i = which[k];
    if (!flow[k].found || !features.HasDepth(i)) continue;
    PoseObservation observation;
    const double sigma_px = kFlowSigma_px * levels.scale(features.level[i]);
    observation.uv_px = camera.Undistort(flow[k].image_px.cast<double>());
    observation.inv_sigma2 = 1 / (sigma_px * sigma_px);
    observation.p_w = features.PointInCamera(i, camera);  // "world" is the camera now
    observations.push_back(observation);
  }
  return observations;
}

std::optional<Rigid3d> EstimateByConsensus(const Camera& camera,
                                           const std::vector<PoseObservation>& observations,
                                           uint64_t seed) {
  std::vector<PnpMatch> matches;
  matches.reserve(observations.size());
  for (const PoseObservation& o : observations)
    matches.push_back({o.p_w, o.uv_px, 1 / o.inv_sigma2});
  PnpOptions options;
  options.ransac.max_iterations = 100;
  options.ransac.min_inliers = kFewestInliers;
  options.ransac.seed = seed;
  const std::optional<PnpEstimate> estimate = EstimatePose(camera, matches, options);
  if (!estimate) return std::nullopt;
  return estimate->T_cw;
}

}  // namespace

CameraMotion EstimateCameraMotion(const Camera& camera, const ScaleLevels& levels,
                                  const FrameFeatures& features, std::span<const int> which,
                                  std::span<const FlowPoint> flow,
                                  const Rigid3d& T_past_now_predicted, uint64_t seed) {
  const std::vector<PoseObservation> observations = Observe(camera, levels, features, which, flow);
  CameraMotion motion;
  motion.T_past_now = T_past_now_predicted;
  motion.num_points = static_cast<int>(observations.size());
  if (motion.num_points < kFewestInliers) return motion;
  PoseOptimizerOptions options;
  options.rounds = 3;
  PoseEstimate estimate = OptimizePose(camera, T_past_now_predicted, observations, options);
  if (2 * estimate.num_inliers < motion.num_points) {
    if (const std::optional<Rigid3d> start = EstimateByConsensus(camera, observations, seed)) {
      const PoseEstimate other = OptimizePose(camera, *start, observations, options);
      if (other.num_inliers > estimate.num_inliers) estimate = other;
    }
  }
  motion.num_inliers = estimate.num_inliers;
  motion.reliable = estimate.num_inliers >= kFewestInliers;
  if (motion.reliable) motion.T_past_now = estimate.T_cw;
  return motion;
}

}  // namespace msf
