// The part of DynamicFilter that follows and finds objects.
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "dynamic/dynamic_filter.h"
#include "dynamic/moving_clusters.h"

namespace msf {
namespace {

ImageBox Moved(const ImageBox& box, const Eigen::Vector2f& by) {
  return {box.x0 + by.x(), box.y0 + by.y(), box.x1 + by.x(), box.y1 + by.y()};
}

Eigen::Vector2f Centre(const ImageBox& box) {
  return {0.5f * (box.x0 + box.x1), 0.5f * (box.y0 + box.y1)};
}

// A weak detection may be clutter, and so may motion seen once, which the past must be free to
// confirm as static.
bool IsEstablished(const ObjectTrack& track, double sure_score) {
  switch (track.kind) {
    case ObjectKind::kKnown:
      return track.best_score >= sure_score;
    case ObjectKind::kUnknown:
      return track.Removes();
    case ObjectKind::kPotential:
      break;
  }
  return false;
}

// The box, wider by `margin` of itself on each side, in blocks.
cv::Rect BlocksAround(const ImageBox& box, float margin) {
  constexpr auto kBlock_px = static_cast<float>(CoarseDepth::kCellSize * BlockRays::kBlockCells);
  const float x = margin * box.width(), y = margin * box.height();
  const cv::Point from(cv::Point2f(box.x0 - x, box.y0 - y) / kBlock_px),
      to(cv::Point2f(box.x1 + x, box.y1 + y) / kBlock_px);
  return {from, to + cv::Point(1, 1)};
}

// Component-wise median.
std::optional<Eigen::Vector2f> MedianOf(const std::vector<Eigen::Vector2f>& shifts,
                                        size_t at_least) {
  if (shifts.size() < at_least) return std::nullopt;
  std::vector<float> x, y;
  for (const Eigen::Vector2f& shift : shifts) {
    x.push_back(shift.x());
    y.push_back(shift.y());
  }
  const auto middle = static_cast<std::ptrdiff_t>(x.size() / 2);
  std::nth_element(x.begin(), x.begin() + middle, x.end());
  std::nth_element(y.begin(), y.begin() + middle, y.end());
  return Eigen::Vector2f(x[middle], y[middle]);
}

// What the camera's motion alone does to a pixel of the past image: how far it moves until now.
Eigen::Vector2f CameraShift(const Camera& camera, const Rigid3d& T_now_past,
                            const Eigen::Vector2f& past_px, double depth_m) {
  constexpr double kUnknownDepth_m = 2;
  const Eigen::Vector3d p = T_now_past * camera.Unproject(camera.Undistort(past_px.cast<double>()),
                                                          depth_m > 0 ? depth_m : kUnknownDepth_m);
  if (p.z() <= 0) return Eigen::Vector2f::Zero();
  return camera.Distort(camera.Project(p)).cast<float>() - past_px;
}

// Share of its points that are seen to move: at the edge of a mover they may seem to lie on what is
// behind it, which stands still.
constexpr double kShareOfAMover = 0.2;

bool MovesAsAWhole(const ObjectMask& mask, const std::vector<TestedPoint>& points,
                   double least_share) {
  MotionEvidence evidence;
  for (const TestedPoint& point : points) {
    if (!mask.Covers(point.image_px)) continue;
    ++evidence.tested;
    evidence.moving += point.moves;
  }
  return evidence.MovingShare() >= least_share;
}

}  // namespace

// Follows points on the object from the image of the detection to this one.
ImageBox DynamicFilter::CarryBox(const ImageBox& box, const PastView& then,
                                 const Work& work) const {
  constexpr size_t kEnough = 6;
  const ObjectMask mask = MaskInBox(then.depth, {}, box, false, std::nullopt, options_.mask);
  // Where a track was there then, it says where to look.
  Eigen::Vector2f guess =
      CameraShift(camera_, then.T_past_now.Inverse(), Centre(box), mask.depth_m);
  float best_iou = static_cast<float>(options_.tracks.min_iou);
  for (const ObjectTrack& track : tracks_.tracks()) {
    const std::optional<ImageBox> past = track.BoxAt(then.frame);
    if (!past || IntersectionOverUnion(*past, box) < best_iou) continue;
    best_iou = IntersectionOverUnion(*past, box);
    guess = Centre(track.box) - Centre(*past);
  }
  return Moved(box, MedianOf(ShiftsSince(then, box, mask, guess, work), kEnough).value_or(guess));
}

// How far points on the object have moved: features where they have been followed already, else a
// grid.
std::vector<Eigen::Vector2f> DynamicFilter::ShiftsSince(const PastView& then, const ImageBox& box,
                                                        const ObjectMask& mask,
                                                        const Eigen::Vector2f& guess,
                                                        const Work& work) const {
  constexpr size_t kEnoughFeatures = 12;
  constexpr int kMostPoints = 64;
  const auto covers = [&](const Eigen::Vector2f& px) {
    return box.Contains(px.x(), px.y()) && mask.Covers(px);
  };
  std::vector<Eigen::Vector2f> shifts;
  if (&then == &past_.back()) {
    for (const int i : work.all) {
      if (work.flow[i].found && covers(work.flow[i].image_px))
        shifts.emplace_back(work.features.image_px[i] - work.flow[i].image_px);
    }
    if (shifts.size() >= kEnoughFeatures) return shifts;
    shifts.clear();
  }
  const int step = std::max(
      3, static_cast<int>(std::sqrt(static_cast<double>(mask.area) / kMostPoints)));  // cells
  std::vector<Eigen::Vector2f> points, guesses;
  for (int r = 0; r < mask.cells.rows; r += step) {
    for (int c = 0; c < mask.cells.cols; c += step) {
      const Eigen::Vector2f px((static_cast<float>(c) + 0.5f) * CoarseDepth::kCellSize,
                               (static_cast<float>(r) + 0.5f) * CoarseDepth::kCellSize);
      if (!covers(px)) continue;
      points.push_back(px);
      guesses.emplace_back(px + guess);
    }
  }
  const std::vector<FlowPoint> flow =
      FollowPoints(then.image, work.view.image, points, guesses, flow_options_);
  for (size_t i = 0; i < points.size(); ++i) {
    if (flow[i].found) shifts.emplace_back(flow[i].image_px - points[i]);
  }
  return shifts;
}

void DynamicFilter::MoveTracks(const Work& work) {
  if (past_.empty()) return;
  constexpr size_t kEnough = 4;
  constexpr float kKeep = 0.7f;  // of the former velocity
  const PastView& last = past_.back();
  const auto dt_s = static_cast<float>(work.frame.time_s - last.time_s);
  for (ObjectTrack& track : tracks_.tracks()) {
    std::vector<Eigen::Vector2f> shifts;
    for (const int i : work.all) {
      if (work.flow[i].found && track.mask.Covers(work.flow[i].image_px))
        shifts.emplace_back(work.features.image_px[i] - work.flow[i].image_px);
    }
    const Eigen::Vector2f by_camera =
        CameraShift(camera_, last.T_past_now.Inverse(), Centre(track.box), track.mask.depth_m);
    const std::optional<Eigen::Vector2f> seen = MedianOf(shifts, kEnough);
    const Eigen::Vector2f shift = seen.value_or(by_camera + track.own_velocity_px_s * dt_s);
    if (seen)
      track.own_velocity_px_s =
          kKeep * track.own_velocity_px_s + (1 - kKeep) * (*seen - by_camera) / dt_s;
    track.box = Moved(track.box, shift);
  }
  // An object that has left the image.
  std::erase_if(tracks_.tracks(), [&](const ObjectTrack& track) {
    constexpr float kVisible_px = 8;
    return track.box.x1 < kVisible_px || track.box.y1 < kVisible_px ||
           track.box.x0 > static_cast<float>(camera_.width) - kVisible_px ||
           track.box.y0 > static_cast<float>(camera_.height) - kVisible_px;
  });
}

// What lies on a large plane that goes on outside is not the object.
void DynamicFilter::ExcludePlanes(Work& work) const {
  if (options_.planes.max_planes == 0 || !options_.depth_split) return;
  constexpr double kMostlyCovered = 0.7;
  const BlockRays& rays = background_.rays();
  cv::Mat1b in_box(rays.rows(), rays.cols(), static_cast<uint8_t>(0)), in_mover = in_box.clone();
  for (const ObjectTrack& track : tracks_.tracks()) {
    if (!IsEstablished(track, options_.tracks.sure_score) || CoversImage(track)) continue;
    const auto margin = static_cast<float>(MaskOptionsFor(track).box_margin);
    const cv::Rect blocks = BlocksAround(track.box, margin);
    cv::rectangle(in_box, blocks, 255, cv::FILLED);
    if (track.kind == ObjectKind::kUnknown) cv::rectangle(in_mover, blocks, 255, cv::FILLED);
  }
  if (cv::countNonZero(in_box) == 0) return;
  work.in_box = in_box;
  // Where boxes cover almost everything there is no outside to go on in.
  const bool outside_shows = cv::countNonZero(in_box) < kMostlyCovered * in_box.total();
  PlaneOptions options = options_.planes;
  if (!outside_shows) options.min_share = options.covered_share;
  if (work.background.rows() == 0) work.background = BlockVerdicts(rays.rows(), rays.cols());
  work.on_plane = FindPlaneBlocks(work.view.depth, rays, outside_shows ? in_box : in_mover,
                                  BlocksInMasks(), options, SeedFor(work));
  for (int r = 0; r < rays.rows(); ++r) {
    for (int c = 0; c < rays.cols(); ++c) {
      const bool is_new = work.background.At(r, c) == BlockVerdict::kIntruder;
      if (work.on_plane(r, c) != 0 && in_box(r, c) != 0 && !is_new)
        work.background.Set(r, c, BlockVerdict::kConfirmed);
    }
  }
}

// Blocks of what was removed from the last image.
cv::Mat1b DynamicFilter::BlocksInMasks() const {
  const BlockRays& rays = background_.rays();
  cv::Mat1b in_mask(rays.rows(), rays.cols(), static_cast<uint8_t>(0));
  for (const ObjectTrack& track : tracks_.tracks()) {
    if (track.mask.empty() || !track.Removes()) continue;
    cv::Mat1b blocks;
    cv::resize(track.mask.cells, blocks, in_mask.size(), 0, 0, cv::INTER_NEAREST);
    in_mask |= blocks;
  }
  return in_mask;
}

void DynamicFilter::GrowMasks(const Work& work) {
  for (ObjectTrack& track : tracks_.tracks()) {
    if (!options_.depth_split) {
      track.mask = WholeBox(work.view.depth, track.box);
      continue;
    }
    std::optional<float> expected_m;
    if (track.mask.depth_m > 0) expected_m = track.mask.depth_m;
    const bool trusted =
        track.confirmed_s == work.frame.time_s && track.score >= options_.tracks.sure_score;
    const auto fit = [&](const ObjectMaskOptions& options) {
      return MaskInBox(work.view.depth, work.background, track.box, trusted, expected_m, options);
    };
    track.mask = fit(MaskOptionsFor(track));
    if (track.kind != ObjectKind::kUnknown) continue;
    if (!GrowsOverWhatMoves(track, work)) {
      ObjectMaskOptions within_box = options_.mask;
      within_box.box_margin = 0;
      track.mask = fit(within_box);
    }
    if (!track.mask.empty()) track.box = track.mask.box;
  }
  tracks_.MergeMovers();
}

// The box of a mover is where motion was seen so far. What it grows by must move, too, or it would
// flow over what it stands on.
bool DynamicFilter::GrowsOverWhatMoves(const ObjectTrack& track, const Work& work) const {
  MotionEvidence beyond;
  for (const int i : work.all) {
    const Eigen::Vector2f& px = work.features.image_px[i];
    if (work.motion[i] == PointMotion::kUntested || !track.mask.Covers(px) ||
        track.box.Contains(px.x(), px.y()))
      continue;
    ++beyond.tested;
    beyond.moving += Moves(work.motion[i]);
  }
  return beyond.tested < options_.tracks.min_tested_points ||
         beyond.MovingShare() >= kShareOfAMover;
}

ObjectMaskOptions DynamicFilter::MaskOptionsFor(const ObjectTrack& track) const {
  ObjectMaskOptions options = options_.mask;
  if (track.kind == ObjectKind::kUnknown) options.box_margin = options.mover_margin;
  return options;
}

void DynamicFilter::FindMovers(const Work& work) {
  std::vector<TestedPoint> points;
  for (const int i : work.all) {
    if (work.motion[i] == PointMotion::kUntested) continue;
    const bool on_object = std::any_of(
        tracks_.tracks().begin(), tracks_.tracks().end(), [&](const ObjectTrack& track) {
          return track.Removes() && track.mask.Covers(work.features.image_px[i]);
        });
    if (on_object) continue;
    points.push_back({work.features.image_px[i], work.features.depth_m[i], Moves(work.motion[i])});
  }
  // While the camera turns, flow errs in whole regions, and a detector tells more.
  constexpr double kShareTurning = 0.5;
  const double least_share = steady_ || !last_detections_.valid() ? kShareOfAMover : kShareTurning;
  for (const std::vector<int>& cluster : FindMovingClusters(points, options_.tracks)) {
    std::vector<Eigen::Vector2f> seeds;
    std::vector<float> depths;
    ImageBox box{1e9f, 1e9f, -1e9f, -1e9f};
    for (const int k : cluster) {
      const Eigen::Vector2f& px = points[k].image_px;
      seeds.push_back(px);
      if (points[k].depth_m > 0) depths.push_back(points[k].depth_m);
      box = {std::min(box.x0, px.x()), std::min(box.y0, px.y()), std::max(box.x1, px.x()),
             std::max(box.y1, px.y())};
    }
    if (depths.size() < 3) continue;
    std::nth_element(depths.begin(),
                     depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2), depths.end());
    const float margin_px = 12 + 0.25f * std::max(box.width(), box.height());
    box = {box.x0 - margin_px, box.y0 - margin_px, box.x1 + margin_px, box.y1 + margin_px};
    const ObjectMask mask = MaskAroundPoints(work.view.depth, work.background, seeds,
                                             depths[depths.size() / 2], box, options_.mask);
    if (!MovesAsAWhole(mask, points, least_share)) continue;
    tracks_.TakeMover(mask, work.frame.time_s);
  }
}

// Connected blocks through which the camera has seen before, outside the masks.
void DynamicFilter::FindIntruders(const Work& work) {
  if (work.background.rows() == 0) return;
  constexpr int kCells = BlockVerdicts::kBlockCells;
  constexpr auto kBlock_px = static_cast<float>(kCells * CoarseDepth::kCellSize);
  cv::Mat1b intruders(work.background.rows(), work.background.cols(), static_cast<uint8_t>(0));
  for (int r = 0; r < intruders.rows; ++r) {
    for (int c = 0; c < intruders.cols; ++c) {
      if (work.background.At(r, c) != BlockVerdict::kIntruder) continue;
      const cv::Point cell(c * kCells, r * kCells);
      const bool known = std::any_of(
          tracks_.tracks().begin(), tracks_.tracks().end(), [&](const ObjectTrack& track) {
            return track.kind != ObjectKind::kUnknown && track.Removes() && !track.mask.empty() &&
                   track.mask.cells(cell) != 0;
          });
      if (!known) intruders(r, c) = 255;
    }
  }
  cv::Mat labels, stats, centres;
  const int count = cv::connectedComponentsWithStats(intruders, labels, stats, centres, 4, CV_32S);
  for (int label = 1; label < count; ++label) {
    if (stats.at<int>(label, cv::CC_STAT_AREA) < options_.background.min_intruder_blocks) continue;
    std::vector<Eigen::Vector2f> seeds;
    std::vector<float> depths;
    for (int r = 0; r < labels.rows; ++r) {
      for (int c = 0; c < labels.cols; ++c) {
        if (labels.at<int>(r, c) != label) continue;
        seeds.emplace_back((static_cast<float>(c) + 0.25f) * kBlock_px,
                           (static_cast<float>(r) + 0.25f) * kBlock_px);
        depths.push_back(work.view.depth.At(seeds.back()));
      }
    }
    std::nth_element(depths.begin(),
                     depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2), depths.end());
    const auto x = static_cast<float>(stats.at<int>(label, cv::CC_STAT_LEFT)) * kBlock_px,
               y = static_cast<float>(stats.at<int>(label, cv::CC_STAT_TOP)) * kBlock_px;
    const auto w = static_cast<float>(stats.at<int>(label, cv::CC_STAT_WIDTH)) * kBlock_px,
               h = static_cast<float>(stats.at<int>(label, cv::CC_STAT_HEIGHT)) * kBlock_px;
    const float margin_px = 16 + 0.5f * std::max(w, h);
    const ObjectMask mask = MaskAroundPoints(
        work.view.depth, work.background, seeds, depths[depths.size() / 2],
        {x - margin_px, y - margin_px, x + w + margin_px, y + h + margin_px}, options_.mask);
    tracks_.TakeMover(mask, work.frame.time_s);
  }
}

void DynamicFilter::GatherEvidence(const Work& work) {
  for (ObjectTrack& track : tracks_.tracks()) {
    track.evidence = {};
    for (const int i : work.all) {
      if (work.motion[i] == PointMotion::kUntested || !track.mask.Covers(work.features.image_px[i]))
        continue;
      ++track.evidence.tested;
      track.evidence.moving += Moves(work.motion[i]) || Moves(work.slow_motion[i]);
    }
    if (track.mask.empty() || work.background.rows() == 0) continue;
    for (int r = 0; r < work.background.rows(); ++r) {
      for (int c = 0; c < work.background.cols(); ++c) {
        if (track.mask.cells(r * BlockVerdicts::kBlockCells, c * BlockVerdicts::kBlockCells) == 0)
          continue;
        ++track.evidence.blocks;
        track.evidence.new_blocks += work.background.At(r, c) == BlockVerdict::kIntruder;
      }
    }
  }
}

}  // namespace msf
