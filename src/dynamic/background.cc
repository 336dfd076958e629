#include "dynamic/background.h"

#include <cmath>

namespace msf {

void Background::Remember(double time_s, const CoarseDepth& depth, const cv::Mat1b& owners,
                          const Rigid3d& T_cw, bool steady) {
  if (!views_.empty() && time_s - views_.back().time_s < options_.keep_every_s) return;
  views_.push_back({time_s, depth, owners, T_cw, steady});
  while (time_s - views_.front().time_s > options_.oldest_s) views_.pop_front();
}

void Background::ChangeWorld(const Rigid3d& T_old_new) {
  for (View& view : views_) view.T_cw = view.T_cw * T_old_new;
}

// A few views, evenly spread over the ages.
std::vector<const Background::View*> Background::Choose(double time_s) const {
  std::vector<const View*> chosen;
  for (int k = 0; k < options_.num_views; ++k) {
    const double step_s =
        (options_.oldest_s - options_.youngest_s) / std::max(1, options_.num_views - 1);
    const double least_age_s = options_.youngest_s + k * step_s;
    const View* best = nullptr;
    for (const View& view : views_) {
      if (time_s - view.time_s >= least_age_s - 0.5 * options_.keep_every_s) best = &view;
    }
    if (best && (chosen.empty() || chosen.back() != best)) chosen.push_back(best);
  }
  return chosen;
}

BlockVerdict Background::CompareWith(const View& view, const Eigen::Vector3d& p_past) const {
  constexpr double kNearest_m = 0.2;
  if (p_past.z() < kNearest_m) return BlockVerdict::kUnknown;
  const Eigen::Vector2d px = camera_.Distort(camera_.Project(p_past));
  if (!(px.x() >= 0 && px.y() >= 0 && px.x() < camera_.width && px.y() < camera_.height))
    return BlockVerdict::kUnknown;
  const cv::Point cell = view.depth.CellOf(static_cast<float>(px.x()), static_cast<float>(px.y()));
  const double tolerance_m =
      options_.tolerance_m + options_.tolerance_per_m2 * p_past.z() * p_past.z();
  // Two cells around for the poses' errors: agreement needs one of the nearer ones, seeing through
  // needs all.
  const std::optional<CellOwner> owner = OwnerOfDepth(view, cell, p_past.z(), tolerance_m);
  if (owner == CellOwner::kWorld) return BlockVerdict::kConfirmed;
  if (owner == CellOwner::kSomebody) return BlockVerdict::kSomebody;
  int beyond = 0, valid = 0;
  for (int r = std::max(0, cell.y - 2); r <= std::min(view.depth.rows() - 1, cell.y + 2); ++r) {
    for (int c = std::max(0, cell.x - 2); c <= std::min(view.depth.cols() - 1, cell.x + 2); ++c) {
      const double d = view.depth.metres()(r, c);
      if (d <= 0) continue;
      ++valid;
      beyond += d > p_past.z() + 2 * tolerance_m;
    }
  }
  constexpr int kEnough = 12;
  return valid >= kEnough && beyond == valid ? BlockVerdict::kIntruder : BlockVerdict::kUnknown;
}

std::optional<CellOwner> Background::OwnerOfDepth(const View& view, const cv::Point& cell,
                                                  double depth_m, double tolerance_m) {
  std::optional<CellOwner> found;
  for (int r = std::max(0, cell.y - 1); r <= std::min(view.depth.rows() - 1, cell.y + 1); ++r) {
    for (int c = std::max(0, cell.x - 1); c <= std::min(view.depth.cols() - 1, cell.x + 1); ++c) {
      const double d = view.depth.metres()(r, c);
      if (d <= 0 || std::abs(d - depth_m) > tolerance_m) continue;
      const CellOwner owner = view.OwnerOf(r, c);
      if (owner == CellOwner::kWorld) return owner;
      if (found != CellOwner::kSomebody) found = owner;
    }
  }
  return found;
}

// One view is enough to know a surface again, but a mask may be wrong once, and where most views
// know the surface as the world's it is.
BlockVerdict Background::Decide(const Votes& votes) const {
  if (votes.intruder > votes.confirmed) return BlockVerdict::kIntruder;
  const bool remembers =
      options_.min_memory_views > 0 && votes.somebody >= options_.min_memory_views;
  if (remembers && votes.somebody > votes.confirmed) return BlockVerdict::kSomebody;
  return votes.confirmed > 0 ? BlockVerdict::kConfirmed : BlockVerdict::kUnknown;
}

BlockVerdicts Background::Compare(double time_s, const CoarseDepth& depth, const Rigid3d& T_cw,
                                  bool steady) const {
  BlockVerdicts verdicts(rays_.rows(), rays_.cols());
  const std::vector<const View*> views = Choose(time_s);
  if (views.empty()) return verdicts;
  const Rigid3d T_wc = T_cw.Inverse();
  std::vector<Rigid3d> T_past_now;
  T_past_now.reserve(views.size());
  for (const View* view : views) T_past_now.push_back(view->T_cw * T_wc);
  for (int r = 0; r < verdicts.rows(); ++r) {
    for (int c = 0; c < verdicts.cols(); ++c) {
      const Eigen::Vector3d p = rays_.Point(depth, r, c).cast<double>();
      if (p.z() <= 0) continue;
      Votes votes;
      for (size_t k = 0; k < views.size(); ++k) {
        const BlockVerdict verdict = CompareWith(*views[k], T_past_now[k] * p);
        votes.confirmed += verdict == BlockVerdict::kConfirmed;
        votes.somebody += verdict == BlockVerdict::kSomebody;
        votes.intruder += verdict == BlockVerdict::kIntruder && steady && views[k]->steady;
      }
      verdicts.Set(r, c, Decide(votes));
    }
  }
  return verdicts;
}

}  // namespace msf
