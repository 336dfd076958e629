#include "dynamic/background.h"

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace msf {
namespace {

cv::Mat SquareAround(int cells) { return cv::Mat1b::ones(2 * cells + 1, 2 * cells + 1); }

// The nearest depth up to so many cells around each one; infinity where there is none.
cv::Mat1f NearestAround(const cv::Mat1f& depth_m, int cells) {
  cv::Mat1f nearest_m = depth_m.clone();
  nearest_m.setTo(std::numeric_limits<float>::infinity(), depth_m <= 0);
  cv::erode(nearest_m, nearest_m, SquareAround(cells));
  return nearest_m;
}

// The nearest depth up to two cells around each one, 0 where most of these have none.
cv::Mat1f ClearDepth(const cv::Mat1f& depth_m) {
  constexpr int kReach = 2, kEnough = 12;
  cv::Mat1f clear_m = NearestAround(depth_m, kReach), valid;
  cv::boxFilter(cv::Mat(depth_m > 0) / 255, valid, CV_32F, {2 * kReach + 1, 2 * kReach + 1},
                {-1, -1}, false, cv::BORDER_CONSTANT);
  clear_m.setTo(0, valid < kEnough);
  return clear_m;
}

}  // namespace

void Background::Remember(double time_s, const CoarseDepth& depth, const cv::Mat1b& owners,
                          const Rigid3d& T_cw, bool steady) {
  if (!views_.empty() && time_s - views_.back().time_s < options_.keep_every_s) return;
  View view{time_s, depth, owners, T_cw, steady};
  view.nearest_m = NearestAround(depth.metres(), 1);
  cv::dilate(depth.metres(), view.farthest_m, SquareAround(1));
  view.clear_m = ClearDepth(depth.metres());
  views_.push_back(std::move(view));
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
  const bool sees_through = view.clear_m(cell) > p_past.z() + 2 * tolerance_m;
  return sees_through ? BlockVerdict::kIntruder : BlockVerdict::kUnknown;
}

std::optional<CellOwner> Background::OwnerOfDepth(const View& view, const cv::Point& cell,
                                                  double depth_m, double tolerance_m) {
  const auto agrees = [&](float d) { return d > 0 && std::abs(d - depth_m) <= tolerance_m; };
  if (agrees(view.depth.metres()(cell)) && view.OwnerOf(cell.y, cell.x) == CellOwner::kWorld)
    return CellOwner::kWorld;  // most blocks are done here
  std::optional<CellOwner> found;
  if (view.nearest_m(cell) > depth_m + tolerance_m || view.farthest_m(cell) < depth_m - tolerance_m)
    return found;
  for (int r = std::max(0, cell.y - 1); r <= std::min(view.depth.rows() - 1, cell.y + 1); ++r) {
    const float* metres = view.depth.metres()[r];
    for (int c = std::max(0, cell.x - 1); c <= std::min(view.depth.cols() - 1, cell.x + 1); ++c) {
      if (!agrees(metres[c])) continue;
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
  std::vector<Votes> votes(static_cast<size_t>(verdicts.rows()) * verdicts.cols());
  auto views_left = static_cast<int>(views.size());
  for (const View* view : views) {
    const Rigid3d T_past_now = view->T_cw * T_wc;
    // A quaternion would take twice the work per point.
    const Eigen::Matrix3d R_past_now = T_past_now.RotationMatrix();
    auto vote = votes.begin();
    for (int r = 0; r < verdicts.rows(); ++r) {
      for (int c = 0; c < verdicts.cols(); ++c, ++vote) {
        if (vote->IsConfirmed(views_left)) continue;
        const Eigen::Vector3d p = rays_.Point(depth, r, c).cast<double>();
        if (p.z() <= 0) continue;
        const Eigen::Vector3d p_past = R_past_now * p + T_past_now.translation();
        const BlockVerdict verdict = CompareWith(*view, p_past);
        vote->confirmed += verdict == BlockVerdict::kConfirmed;
        vote->somebody += verdict == BlockVerdict::kSomebody;
        vote->intruder += verdict == BlockVerdict::kIntruder && steady && view->steady;
      }
    }
    --views_left;
  }
  auto vote = votes.begin();
  for (int r = 0; r < verdicts.rows(); ++r) {
    for (int c = 0; c < verdicts.cols(); ++c) verdicts.Set(r, c, Decide(*vote++));
  }
  return verdicts;
}

}  // namespace msf
