// The part of DynamicFilter that says which points are used, and with what weight.
#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "dynamic/dynamic_filter.h"

namespace msf {
namespace {

// Static probabilities. Points that are not used at all have less than
// DynamicOptions::min_static_probability. Of these the map may take back (see
// TrackingOptions::readmit_probability) the ones that a single test speaks against.
constexpr float kOnObject = 0.05f;
constexpr float kStillOnObject = 0.15f;
constexpr float kMovesTwice = 0.1f;
constexpr float kMovesOnce = 0.25f;
constexpr float kReadmittedWeight = 0.3f;

// Cells that are at most `reach_px` away from those of the mask.
cv::Mat1b Surroundings(const cv::Mat1b& mask, double reach_px) {
  if (cv::countNonZero(mask) == 0) return mask;
  cv::Mat1f distance;
  cv::distanceTransform(mask == 0, distance, cv::DIST_L2, cv::DIST_MASK_3);
  return distance <= reach_px / CoarseDepth::kCellSize;
}

}  // namespace

void DynamicFilter::DropInBoxes(const Work& work, DynamicResult& result) const {
  result.mask = cv::Mat1b(work.view.depth.rows(), work.view.depth.cols(), static_cast<uint8_t>(0));
  for (const Detection& detection : work.detections) {
    const std::optional<ObjectKind> kind = tracks_.roles().KindOf(detection.class_id);
    if (!kind || detection.score < tracks_.roles().StartScoreOf(detection.class_id)) continue;
    result.mask |= WholeBox(work.view.depth, detection.box).cells;
    result.objects.push_back({.name = tracks_.roles().NameOf(detection.class_id),
                              .kind = *kind,
                              .removed = true,
                              .score = detection.score,
                              .box = detection.box});
    for (const int i : work.all) {
      const Eigen::Vector2f& px = work.features.image_px[i];
      if (detection.box.Contains(px.x(), px.y()))
        result.labels.Set(i, PointReason::kBox, kOnObject);
    }
  }
}

// Table 2 of the paper as printed: the raw flow, camera motion included, must not exceed L.
void DynamicFilter::DropByRawFlow(const Work& work, DynamicResult& result) const {
  if (past_.empty()) return;
  const std::vector<FlowPoint> flow =
      FollowPoints(work.view.image, past_.back().image, work.features.image_px, {}, flow_options_);
  for (const int i : work.all) {
    if (result.labels.reason[i] != PointReason::kStatic || !flow[i].found) continue;
    const double moved_px = (flow[i].image_px - work.features.image_px[i]).norm();
    if (moved_px > options_.paper_flow_px) result.labels.Set(i, PointReason::kFlow, kOnObject);
  }
}

// Nothing covers most of the image, unless it is seen to move.
bool DynamicFilter::IsCredible(const ObjectTrack& track) const {
  if (MaskShare(track) > options_.mask.max_image_share) return false;
  const bool is_large = track.kind == ObjectKind::kUnknown
                            ? MaskShare(track) > options_.mask.max_mover_share
                            : CoversImage(track);
  return !is_large || track.evidence.SpeaksForMotion();
}

double DynamicFilter::MaskShare(const ObjectTrack& track) const {
  return static_cast<double>(track.mask.area) / static_cast<double>(track.mask.cells.total());
}

bool DynamicFilter::CoversImage(const ObjectTrack& track) const {
  return track.box.area() > options_.mask.max_image_share * camera_.width * camera_.height;
}

// Where somebody was seen before and still is, by depth, though no detection says so now: he may be
// half out of the image or turned away.
cv::Mat1b DynamicFilter::RememberedCells(const Work& work) const {
  constexpr int kSmooth = 3;  // blocks: single ones are chance
  const cv::Size size(work.view.depth.cols(), work.view.depth.rows());
  if (work.background.rows() == 0) return cv::Mat1b(size, static_cast<uint8_t>(0));
  cv::Mat1b cells(work.background.rows(), work.background.cols(), static_cast<uint8_t>(0));
  for (int r = 0; r < cells.rows; ++r) {
    for (int c = 0; c < cells.cols; ++c) {
      if (work.background.At(r, c) == BlockVerdict::kSomebody) cells(r, c) = 255;
    }
  }
  cv::medianBlur(cells, cells, kSmooth);
  cv::resize(cells, cells, size, 0, 0, cv::INTER_NEAREST);
  return cells;
}

void DynamicFilter::LabelPoints(const Work& work, DynamicResult& result) const {
  result.mask = cv::Mat1b(work.view.depth.rows(), work.view.depth.cols(), static_cast<uint8_t>(0));
  cv::Mat1b settled = result.mask.clone(), movers = result.mask.clone();
  cv::Mat1b unconfirmed = result.mask.clone();
  for (const ObjectTrack& track : tracks_.tracks()) {
    if (track.mask.empty() || !IsCredible(track)) continue;
    if (track.Removes()) result.mask |= track.mask.cells;
    if (track.Removes() && track.kind == ObjectKind::kUnknown) movers |= track.mask.cells;
    if (!track.Removes() && track.kind == ObjectKind::kUnknown) unconfirmed |= track.mask.cells;
    if (track.kind == ObjectKind::kKnown && track.state == MotionState::kStatic)
      settled |= track.mask.cells;
  }
  result.mask |= RememberedCells(work) & ~settled;
  // Without a detector flow is all that tells a mover from the room.
  cv::Mat1b suspicious(result.mask.size(), static_cast<uint8_t>(255));
  if (last_detections_.valid())
    suspicious = Surroundings(result.mask | unconfirmed, options_.suspect_reach_px);
  for (const int i : work.all) {
    const Eigen::Vector2f& px = work.features.image_px[i];
    const cv::Point cell = work.view.depth.CellOf(px.x(), px.y());
    if (result.mask(cell) != 0) {
      // A detection says that there is an object, not which of the points around it are its own.
      const bool is_still = work.motion[i] == PointMotion::kStatic && !Moves(work.slow_motion[i]) &&
                            movers(cell) == 0;
      result.labels.Set(i, PointReason::kObject, is_still ? kStillOnObject : kOnObject);
    } else if (result.camera_motion_reliable && work.motion[i] == PointMotion::kMovesSideways &&
               suspicious(cell) == 0) {
      // Flow errs now and then: what moves alone is rather a point that was followed badly.
      result.labels.Set(i, PointReason::kReadmitted, DoubtfulWeight());
    } else if (result.camera_motion_reliable && Moves(work.motion[i])) {
      const PointReason reason =
          work.motion[i] == PointMotion::kMovesInDepth ? PointReason::kDepth : PointReason::kFlow;
      result.labels.Set(i, reason, Moves(work.slow_motion[i]) ? kMovesTwice : kMovesOnce);
    } else if (settled(cell) != 0) {
      result.labels.Set(i, PointReason::kSettled,
                        static_cast<float>(options_.tracks.settled_weight));
    }
  }
}

// Of suspicious points that are used all the same.
float DynamicFilter::DoubtfulWeight() const {
  return std::max(kReadmittedWeight, static_cast<float>(options_.min_static_probability));
}

// Rather than losing track: those that do not move themselves first, and never those that do.
void DynamicFilter::ReadmitPoints(const Work& work, DynamicResult& result) const {
  const PointLabels& labels = result.labels;
  const auto used = [&](int i) {
    return labels.static_probability[i] >= static_cast<float>(options_.min_static_probability);
  };
  int missing = options_.min_static_features -
                static_cast<int>(std::count_if(work.all.begin(), work.all.end(), used));
  if (missing <= 0) return;
  for (const PointMotion wanted : {PointMotion::kStatic, PointMotion::kUntested}) {
    for (const int i : work.all) {
      if (missing == 0) return;
      if (used(i) || work.motion[i] != wanted || Moves(work.slow_motion[i])) continue;
      result.labels.Set(i, PointReason::kReadmitted, DoubtfulWeight());
      --missing;
    }
  }
}

}  // namespace msf
