#include "estimation/pnp.h"

#include <opencv2/calib3d.hpp>

namespace msf {
namespace {

struct CvMatches {
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;

  void Add(const PnpMatch& match) {
    points.emplace_back(match.p_w.x(), match.p_w.y(), match.p_w.z());
    pixels.emplace_back(match.uv_px.x(), match.uv_px.y());
  }
};

cv::Matx33d Intrinsics(const Camera& camera) {
  return {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1};
}

Rigid3d ToRigid(const cv::Mat& rotation_vector, const cv::Mat& translation) {
  const Eigen::Map<const Eigen::Vector3d> w(rotation_vector.ptr<double>()),
      t(translation.ptr<double>());
  return {ExpRotation(w), t};
}

// At most four poses that map three points onto their pixels.
void SolveThreePoints(const Camera& camera, const CvMatches& sample, std::vector<Rigid3d>& poses) {
  std::vector<cv::Mat> rotation_vectors, translations;
  cv::solveP3P(sample.points, sample.pixels, Intrinsics(camera), cv::noArray(), rotation_vectors,
               translations, cv::SOLVEPNP_AP3P);
  for (size_t i = 0; i < rotation_vectors.size(); ++i) {
    const Rigid3d T_cw = ToRigid(rotation_vectors[i], translations[i]);
    if (T_cw.rotation().coeffs().allFinite() && T_cw.translation().allFinite())
      poses.push_back(T_cw);
  }
}

// The least-squares pose of the inliers.
Rigid3d Refine(const Camera& camera, std::span<const PnpMatch> matches,
               const Consensus<Rigid3d>& consensus) {
  CvMatches inliers;
  for (size_t i = 0; i < matches.size(); ++i) {
    if (consensus.inlier[i]) inliers.Add(matches[i]);
  }
  const Eigen::Vector3d w = LogRotation(consensus.model.rotation()),
                        t = consensus.model.translation();
  cv::Mat rotation_vector = (cv::Mat_<double>(3, 1) << w.x(), w.y(), w.z());
  cv::Mat translation = (cv::Mat_<double>(3, 1) << t.x(), t.y(), t.z());
  cv::solvePnPRefineLM(inliers.points, inliers.pixels, Intrinsics(camera), cv::noArray(),
                       rotation_vector, translation);
  return ToRigid(rotation_vector, translation);
}

}  // namespace

Status PnpOptions::Check() const {
  if (!(chi2 > 0)) return Status::Error("pnp: chi2 must be positive");
  return ransac.Check();
}

std::optional<PnpEstimate> EstimatePose(const Camera& camera, std::span<const PnpMatch> matches,
                                        const PnpOptions& options) {
  const int size = static_cast<int>(matches.size());
  const auto is_inlier = [&](const Rigid3d& T_cw, int i) {
    const Eigen::Vector3d p_c = T_cw * matches[i].p_w;
    if (!(p_c.z() > 0)) return false;
    return (camera.Project(p_c) - matches[i].uv_px).squaredNorm() <=
           options.chi2 * matches[i].sigma2_px2;
  };
  const auto fit = [&](const std::array<int, 3>& sample, std::vector<Rigid3d>& poses) {
    CvMatches three;
    for (const int i : sample) {
      if (!matches[i].p_w.allFinite() || !matches[i].uv_px.allFinite()) return;
      three.Add(matches[i]);
    }
    SolveThreePoints(camera, three, poses);
  };
  std::optional<Consensus<Rigid3d>> best = Ransac<Rigid3d, 3>(size, options.ransac, fit, is_inlier);
  if (!best) return std::nullopt;
  // Twice, because the refined pose gathers inliers that a pose of three noisy points misses.
  for (int i = 0; i < 2; ++i) {
    Consensus<Rigid3d> refined = FindConsensus(Refine(camera, matches, *best), size, is_inlier);
    if (refined.num_inliers < best->num_inliers) break;
    best = std::move(refined);
  }
  return PnpEstimate{best->model, std::move(best->inlier), best->num_inliers};
}

}  // namespace msf
