#include "estimation/rigid_alignment_ransac.h"

#include "geometry/alignment.h"

namespace msf {
namespace {

// Both directions at hand: the test needs them for every match.
struct Motion {
  Rigid3d T_12, T_21;

  explicit Motion(const Rigid3d& T_c1_c2) : T_12(T_c1_c2), T_21(T_c1_c2.Inverse()) {}
};

// Three points this close to a line do not fix the turn around it, m^2 (twice the area of their
// triangle).
constexpr double kMinArea_m2 = 1e-4;

bool SpanTriangle(const std::vector<Eigen::Vector3d>& p) {
  return (p[1] - p[0]).cross(p[2] - p[0]).norm() > kMinArea_m2;
}

bool ProjectsWithin(const Camera& camera, const Eigen::Vector3d& moved_c,
                    const Eigen::Vector3d& own_c, double gate_px2) {
  if (!(moved_c.z() > 0 && own_c.z() > 0)) return false;
  return (camera.Project(moved_c) - camera.Project(own_c)).squaredNorm() <= gate_px2;
}

template <typename Indices>
std::optional<Rigid3d> AlignMatches(std::span<const RigidMatch> matches, const Indices& indices) {
  std::vector<Eigen::Vector3d> from, to;
  for (const int i : indices) {
    if (!matches[i].p_c1.allFinite() || !matches[i].p_c2.allFinite()) return std::nullopt;
    from.push_back(matches[i].p_c2);
    to.push_back(matches[i].p_c1);
  }
  if (from.size() == 3 && !(SpanTriangle(from) && SpanTriangle(to))) return std::nullopt;
  const std::optional<Similarity3d> alignment = AlignPoints(from, to);
  return alignment ? std::optional(alignment->motion) : std::nullopt;
}

std::optional<Rigid3d> Refine(std::span<const RigidMatch> matches,
                              const Consensus<Motion>& consensus) {
  std::vector<int> inliers;
  for (size_t i = 0; i < matches.size(); ++i) {
    if (consensus.inlier[i]) inliers.push_back(static_cast<int>(i));
  }
  return AlignMatches(matches, inliers);
}

}  // namespace

Status RigidAlignmentOptions::Check() const {
  if (!(chi2 > 0)) return Status::Error("rigid alignment: chi2 must be positive");
  return ransac.Check();
}

std::optional<RigidAlignment> AlignRigidly(const Camera& camera,
                                           std::span<const RigidMatch> matches,
                                           const RigidAlignmentOptions& options) {
  const int size = static_cast<int>(matches.size());
  const auto is_inlier = [&](const Motion& motion, int i) {
    const RigidMatch& match = matches[i];
    return ProjectsWithin(camera, motion.T_12 * match.p_c2, match.p_c1,
                          options.chi2 * match.sigma2_1_px2) &&
           ProjectsWithin(camera, motion.T_21 * match.p_c1, match.p_c2,
                          options.chi2 * match.sigma2_2_px2);
  };
  const auto fit = [&](const std::array<int, 3>& sample, std::vector<Motion>& motions) {
    if (const std::optional<Rigid3d> T_12 = AlignMatches(matches, sample))
      motions.emplace_back(*T_12);
  };
  std::optional<Consensus<Motion>> best = Ransac<Motion, 3>(size, options.ransac, fit, is_inlier);
  if (!best) return std::nullopt;
  // Twice, because the refined motion gathers inliers that one of three noisy points misses.
  for (int i = 0; i < 2; ++i) {
    const std::optional<Rigid3d> T_12 = Refine(matches, *best);
    if (!T_12) break;
    Consensus<Motion> refined = FindConsensus(Motion(*T_12), size, is_inlier);
    if (refined.num_inliers < best->num_inliers) break;
    best = std::move(refined);
  }
  return RigidAlignment{best->model.T_12, std::move(best->inlier), best->num_inliers};
}

}  // namespace msf
