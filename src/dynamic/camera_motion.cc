#include "dynamic/camera_motion.h"

#include "estimation/pnp.h"

namespace msf {
namespace {

constexpr size_t kFewestInliers = 15;
constexpr size_t kFewestLandmarks = 12;
// Movers may have most of the features that the detector has not explained, but not of what the map
// holds as static.
constexpr double kLeastFeatureShare = 0.25;
constexpr double kLeastLandmarkShare = 0.5;
constexpr double kFlowSigma_px = 0.5;
constexpr double kLandmarkSigma_px = 0.7;  // of mixed pyramid levels

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
  options.ransac.min_inliers = kFewestLandmarks;
  options.ransac.seed = seed;
  const std::optional<PnpEstimate> estimate = EstimatePose(camera, matches, options);
  if (!estimate) return std::nullopt;
  return estimate->T_cw;
}

struct Agreement {
  PoseEstimate pose;  // takes the coordinates of the observations to the camera that made them
  int num_points = 0;
  double InlierShare() const {
    return num_points > 0 ? static_cast<double>(pose.num_inliers) / num_points : 0;
  }
};

// What most of the observations agree on: from the prediction, or by RANSAC (seeded) where fewer
// than half of them agree with what was found from there.
Agreement FindAgreement(const Camera& camera, const std::vector<PoseObservation>& observations,
                        const Rigid3d& predicted, uint64_t seed) {
  PoseOptimizerOptions options;
  options.rounds = 3;
  Agreement found{OptimizePose(camera, predicted, observations, options),
                  static_cast<int>(observations.size())};
  if (found.InlierShare() >= 0.5) return found;
  if (const std::optional<Rigid3d> start = EstimateByConsensus(camera, observations, seed)) {
    const PoseEstimate other = OptimizePose(camera, *start, observations, options);
    if (other.num_inliers > found.pose.num_inliers) found.pose = other;
  }
  return found;
}

CameraMotion ToMotion(const Agreement& found, bool reliable, const Rigid3d& T_past_now,
                      const Rigid3d& T_past_now_predicted) {
  return {reliable ? T_past_now : T_past_now_predicted, found.num_points, found.pose.num_inliers,
          reliable};
}

}  // namespace

CameraMotion EstimateCameraMotion(const Camera& camera, const ScaleLevels& levels,
                                  const FrameFeatures& features, std::span<const int> which,
                                  std::span<const FlowPoint> flow,
                                  const Rigid3d& T_past_now_predicted, uint64_t seed) {
  const std::vector<PoseObservation> observations = Observe(camera, levels, features, which, flow);
  if (observations.size() < kFewestInliers)
    return {T_past_now_predicted, static_cast<int>(observations.size()), 0, false};
  const Agreement found = FindAgreement(camera, observations, T_past_now_predicted, seed);
  const bool reliable = found.pose.num_inliers >= static_cast<int>(kFewestInliers) &&
                        found.InlierShare() >= kLeastFeatureShare;
  return ToMotion(found, reliable, found.pose.T_cw, T_past_now_predicted);
}

CameraMotion EstimateCameraMotion(const Camera& camera, std::span<const Landmark> landmarks,
                                  std::span<const FlowPoint> flow,
                                  const Rigid3d& T_past_now_predicted, uint64_t seed) {
  std::vector<PoseObservation> observations;
  for (size_t k = 0; k < landmarks.size(); ++k) {
    if (!flow[k].found) continue;
    PoseObservation observation;
    observation.uv_px = camera.Undistort(flow[k].image_px.cast<double>());
    observation.inv_sigma2 = 1 / (kLandmarkSigma_px * kLandmarkSigma_px);
    observation.p_w = landmarks[k].p_c;  // "world" is the past camera
    observations.push_back(observation);
  }
  if (observations.size() < kFewestLandmarks)
    return {T_past_now_predicted, static_cast<int>(observations.size()), 0, false};
  const Agreement found = FindAgreement(camera, observations, T_past_now_predicted.Inverse(), seed);
  return ToMotion(found, found.InlierShare() > kLeastLandmarkShare, found.pose.T_cw.Inverse(),
                  T_past_now_predicted);
}

}  // namespace msf
