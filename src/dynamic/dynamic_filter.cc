#include "dynamic/dynamic_filter.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace msf {
namespace {

constexpr double kUsualInterval_s = 1.0 / 30;
constexpr size_t kFewestViews = 2;  // kept, at however low a frame rate

// Detections come from outside: boxes are cut to the image, what makes no sense is left out.
std::vector<Detection> Sane(const std::vector<Detection>& detections, const Camera& camera) {
  std::vector<Detection> sane;
  for (Detection detection : detections) {
    ImageBox& box = detection.box;
    if (!std::isfinite(box.x0 + box.y0 + box.x1 + box.y1) || !std::isfinite(detection.score))
      continue;
    box = {std::max(box.x0, 0.0f), std::max(box.y0, 0.0f),
           std::min(box.x1, static_cast<float>(camera.width)),
           std::min(box.y1, static_cast<float>(camera.height))};
    constexpr float kSmallest_px = 4;
    if (box.width() >= kSmallest_px && box.height() >= kSmallest_px) sane.push_back(detection);
  }
  std::stable_sort(sane.begin(), sane.end(),
                   [](const Detection& a, const Detection& b) { return a.score > b.score; });
  return sane;
}

// Options in pixels are those of images 640 px wide.
DynamicOptions ForImageWidth(const DynamicOptions& options, int width) {
  const double scale = width / 640.0;
  DynamicOptions scaled = options;
  scaled.suspect_reach_px *= scale;
  scaled.tracks.cluster_px *= scale;
  scaled.background.max_turn_px *= scale;
  scaled.background.min_intruder_blocks =
      static_cast<int>(std::lround(scale * scale * options.background.min_intruder_blocks));
  return scaled;
}

}  // namespace

StatusOr<std::unique_ptr<DynamicFilter>> DynamicFilter::Create(
    const DynamicOptions& options, const Camera& camera, const ScaleLevels& levels,
    const std::vector<std::string>& class_names, uint64_t seed) {
  if (const Status status = options.Check(); !status.ok()) return status;
  StatusOr<ClassRoles> roles = ClassRoles::Create(options, class_names);
  if (!roles.ok()) return roles.status();
  return std::unique_ptr<DynamicFilter>(
      new DynamicFilter(options, camera, levels, *std::move(roles), seed));
}

DynamicFilter::DynamicFilter(const DynamicOptions& options, const Camera& camera,
                             const ScaleLevels& levels, ClassRoles roles, uint64_t seed)
    : options_(ForImageWidth(options, camera.width)),
      camera_(camera),
      levels_(levels),
      seed_(seed),
      flow_options_(options.flow),
      tracks_(options_.tracks, std::move(roles)),
      background_(options_.background, camera) {
  if (options.mode == "paper") {
    flow_options_.shrink = 1;
    flow_options_.window_px = options.paper_window_px;
    flow_options_.levels = 3;       // of the whole image
    flow_options_.iterations = 20;  // a small window converges slowly
  }
}

DynamicResult DynamicFilter::Classify(const RgbdFrame& frame, const FrameFeatures& features,
                                      const Rigid3d& T_last_now_predicted,
                                      const Detections* detections) {
  DynamicResult result;
  result.labels = PointLabels(features.size());
  if (options_.mode == "off") return result;
  Work work{.frame = frame, .features = features};
  work.all.resize(features.size());
  std::iota(work.all.begin(), work.all.end(), 0);
  work.view.frame = frame.id;
  work.view.time_s = frame.time_s;
  work.view.depth = CoarseDepth(frame);
  if (options_.mode != "boxes") work.view.image = FlowImage(frame.color, flow_options_);
  if (detections) {
    result.detection_age = static_cast<int>(frame.id.value() - detections->frame.value());
    if (options_.mode != "full") work.detections = Sane(detections->objects, camera_);
  }
  if (options_.mode == "full") {
    ClassifyByMotion(work, detections, T_last_now_predicted, result);
  } else {
    DropInBoxes(work, result);
    if (options_.mode == "paper") DropByRawFlow(work, result);
  }
  Describe(work, result);
  Remember(work, result);
  return result;
}

void DynamicFilter::ClassifyByMotion(Work& work, const Detections* detections,
                                     const Rigid3d& T_last_now_predicted, DynamicResult& result) {
  FollowCamera(T_last_now_predicted, work, result);
  T_cw_expected_.reset();
  if (T_cw_last_ && result.camera_motion_reliable && options_.compensate_camera_motion) {
    T_cw_expected_ = past_.back().T_past_now.Inverse() * *T_cw_last_;
    work.background =
        background_.Compare(work.frame.time_s, work.view.depth, *T_cw_expected_, steady_);
  }
  TestMotions(work);
  MoveTracks(work);
  if (detections) TakeDetections(*detections, work);
  ExcludePlanes(work);
  GrowMasks(work);
  if (options_.unknown_movers && result.camera_motion_reliable) {
    FindMovers(work);
    FindIntruders(work);
  }
  TestSlowMotions(work);
  if (result.camera_motion_reliable) {
    GatherEvidence(work);
    tracks_.UpdateStates(work.frame.time_s);
  }
  tracks_.DropLost(work.frame.time_s, options_.bridging);
  LabelPoints(work, result);
  ReadmitPoints(work, result);
  if (options_.weights) return;
  for (float& probability : result.labels.static_probability)
    probability = probability < static_cast<float>(options_.min_static_probability) ? 0.0f : 1.0f;
}

// --- Detections

void DynamicFilter::TakeDetections(const Detections& detections, Work& work) {
  if (last_detections_.valid() && detections.frame <= last_detections_) return;
  double age_s = 0;
  if (detections.frame == work.frame.id) {
    work.detections = Sane(detections.objects, camera_);
  } else {
    const auto then = std::find_if(past_.begin(), past_.end(), [&](const PastView& view) {
      return view.frame == detections.frame;
    });
    if (then == past_.end()) return;  // too old to be placed
    work.detections = CarryToNow(detections, *then, work);
    age_s = work.frame.time_s - then->time_s;
  }
  last_detections_ = detections.frame;
  tracks_.TakeDetections(work.detections, work.frame.time_s, age_s);
}

std::vector<Detection> DynamicFilter::CarryToNow(const Detections& detections, const PastView& then,
                                                 const Work& work) const {
  std::vector<Detection> carried;
  for (Detection detection : Sane(detections.objects, camera_)) {
    if (!tracks_.MayTake(detection, then.frame)) continue;
    detection.box = CarryBox(detection.box, then, work);
    carried.push_back(detection);
  }
  return Sane(carried, camera_);
}

// --- Motion

void DynamicFilter::FollowCamera(const Rigid3d& T_last_now_predicted, Work& work,
                                 DynamicResult& result) {
  work.flow.assign(work.all.size(), {});
  if (past_.empty()) return;
  // What the map has long held as static tells the camera's motion even where people fill the
  // image.
  CameraMotion motion = MotionByLandmarks(T_last_now_predicted, work);
  if (!motion.reliable) {
    const CameraMotion from_rest = MotionByLandmarks({}, work);
    if (from_rest.reliable) motion = from_rest;
  }
  if (motion.reliable) result.T_now_last = motion.T_past_now.Inverse();
  const std::vector<Eigen::Vector2f> guesses =
      PredictInPast(camera_, work.features, work.all, motion.T_past_now);
  work.flow = FollowPoints(work.view.image, past_.back().image, work.features.image_px, guesses,
                           flow_options_);
  if (!motion.reliable) motion = MotionByFeatures(T_last_now_predicted, work);
  result.camera_motion_reliable = motion.reliable;
  // What took coordinates of the last camera into the past now takes those of this one.
  const Rigid3d T_last_now = options_.compensate_camera_motion ? motion.T_past_now : Rigid3d();
  const Vector6d twist = T_last_now.Log();
  const double interval_s = work.frame.time_s - past_.back().time_s;
  for (PastView& view : past_) {
    view.T_past_now = view.T_past_now * T_last_now;
    view.unsteadiness = twist - last_velocity_ * interval_s;
  }
  last_velocity_ = twist / interval_s;
  const double turn_px = last_velocity_.tail<3>().norm() * kUsualInterval_s * camera_.fx;
  steady_ = turn_px < options_.background.max_turn_px;
}

CameraMotion DynamicFilter::MotionByLandmarks(const Rigid3d& T_last_now_predicted,
                                              const Work& work) const {
  std::vector<Eigen::Vector2f> points, guesses;
  const Rigid3d T_now_last = T_last_now_predicted.Inverse();
  for (const Landmark& landmark : landmarks_) {
    const Eigen::Vector3d p = T_now_last * landmark.p_c;
    points.push_back(landmark.image_px);
    guesses.push_back(p.z() > 0 ? camera_.Distort(camera_.Project(p)).cast<float>().eval()
                                : landmark.image_px);
  }
  const std::vector<FlowPoint> flow =
      FollowPoints(past_.back().image, work.view.image, points, guesses, flow_options_);
  return EstimateCameraMotion(camera_, landmarks_, flow, T_last_now_predicted, SeedFor(work));
}

CameraMotion DynamicFilter::MotionByFeatures(const Rigid3d& T_last_now_predicted,
                                             const Work& work) const {
  // Points that were on a person or the like do not take part. Those on movers of other classes do:
  // they are movers only by the camera's motion, which must not depend on them in turn.
  std::vector<int> still;
  std::vector<FlowPoint> flow;
  for (const int i : work.all) {
    const bool on_object = WasOn(work.flow[i].image_px, [](const ObjectTrack& track) {
      return track.kind == ObjectKind::kKnown && track.Removes();
    });
    if (on_object) continue;
    still.push_back(i);
    flow.push_back(work.flow[i]);
  }
  return EstimateCameraMotion(camera_, levels_, work.features, still, flow, T_last_now_predicted,
                              SeedFor(work));
}

// Whether the last image showed such a track there.
template <typename Predicate>
bool DynamicFilter::WasOn(const Eigen::Vector2f& last_px, Predicate such) const {
  return std::any_of(
      tracks_.tracks().begin(), tracks_.tracks().end(),
      [&](const ObjectTrack& track) { return such(track) && track.mask.Covers(last_px); });
}

const PastView* DynamicFilter::ViewBefore(double time_s) const {
  const PastView* found = nullptr;
  for (const PastView& view : past_) {
    if (view.time_s <= time_s) found = &view;
  }
  return found;
}

void DynamicFilter::TestMotions(Work& work) const {
  work.motion.assign(work.all.size(), PointMotion::kUntested);
  work.slow_motion = work.motion;
  if (past_.empty()) return;
  MotionTestPoints points{work.all, work.flow, {}};
  for (const FlowPoint& place : work.flow) {
    points.on_object.push_back(
        WasOn(place.image_px, [](const ObjectTrack& track) { return track.Removes(); }));
  }
  work.motion = TestMotion(camera_, levels_, work.features, points, past_.back(), options_.motion);
}

// Objects may move too slowly for two successive images: their points are compared with an older
// one.
void DynamicFilter::TestSlowMotions(Work& work) const {
  const PastView* before = ViewBefore(work.frame.time_s - options_.motion.look_back_s);
  if (!before || before == &past_.back()) return;
  MotionTestPoints points;
  std::vector<int> others;
  for (const int i : work.all) {
    const auto covers = [&](const ObjectTrack& track) {
      return track.mask.Covers(work.features.image_px[i]);
    };
    const bool on_object = std::any_of(tracks_.tracks().begin(), tracks_.tracks().end(), covers);
    (on_object ? points.which : others).push_back(i);
  }
  const size_t num_on_objects = points.which.size();
  if (num_on_objects == 0) return;
  // A few of the others tell how noisy the comparison is.
  constexpr size_t kReferences = 60;
  const size_t step = others.size() / kReferences + 1;
  for (size_t k = 0; k < others.size(); k += step) points.which.push_back(others[k]);
  points.on_object.assign(num_on_objects, 1);
  points.on_object.resize(points.which.size(), 0);
  std::vector<Eigen::Vector2f> places;
  for (const int i : points.which) places.push_back(work.features.image_px[i]);
  const std::vector<Eigen::Vector2f> guesses =
      PredictInPast(camera_, work.features, points.which, before->T_past_now);
  points.flow = FollowPoints(work.view.image, before->image, places, guesses, flow_options_);
  const std::vector<PointMotion> verdicts =
      TestMotion(camera_, levels_, work.features, points, *before, options_.motion);
  for (size_t k = 0; k < num_on_objects; ++k) work.slow_motion[points.which[k]] = verdicts[k];
}

// --- What others are told

void DynamicFilter::Describe(const Work& work, DynamicResult& result) const {
  for (const ObjectTrack& track : tracks_.tracks()) {
    result.objects.push_back({.id = track.id,
                              .name = tracks_.roles().NameOf(track.class_id),
                              .kind = track.kind,
                              .state = track.state,
                              .removed = track.Removes() && IsCredible(track),
                              .bridged = track.confirmed_s < work.frame.time_s,
                              .score = track.score,
                              .box = track.mask.empty() ? track.box : track.mask.box,
                              .moving_share = track.evidence.MovingShare()});
  }
  if (!result.mask.empty())
    result.mask_share = static_cast<double>(cv::countNonZero(result.mask)) /
                        static_cast<double>(result.mask.total());
}

// What later frames are told of the cells. Cells of objects, and those in the box of one that are
// not on a plane, cannot tell what the static world looked like. Only what is detected well makes
// them somebody's: what is remembered must not prolong itself.
cv::Mat1b DynamicFilter::OwnersOfCells(const Work& work, const DynamicResult& result) const {
  cv::Mat1b owners(result.mask.size(), static_cast<uint8_t>(CellOwner::kWorld));
  const auto give = [&](const cv::Mat1b& cells, CellOwner owner) {
    owners.setTo(static_cast<uint8_t>(owner), cells);
  };
  give(result.mask, CellOwner::kDoubtful);
  if (!work.in_box.empty()) {
    cv::Mat1b doubtful = work.in_box & ~work.on_plane;
    cv::resize(doubtful, doubtful, owners.size(), 0, 0, cv::INTER_NEAREST);
    give(doubtful, CellOwner::kDoubtful);
  }
  for (const ObjectTrack& track : tracks_.tracks()) {
    const bool is_sure =
        track.kind == ObjectKind::kKnown && track.Removes() &&
        track.score >= static_cast<float>(tracks_.roles().StartScoreOf(track.class_id));
    if (is_sure && !track.mask.empty() && IsCredible(track))
      give(track.mask.cells, CellOwner::kSomebody);
  }
  return owners;
}

void DynamicFilter::Remember(Work& work, const DynamicResult& result) {
  mask_share_ = result.mask_share;
  last_owners_ = OwnersOfCells(work, result);
  past_.push_back(std::move(work.view));
  while (past_.size() > kFewestViews && past_[1].time_s <= work.frame.time_s - options_.history_s)
    past_.pop_front();
  tracks_.RememberBoxes(work.frame.id, past_.size());
}

void DynamicFilter::TakePose(const std::optional<Rigid3d>& T_cw, bool same_world,
                             std::vector<Landmark> landmarks) {
  landmarks_ = std::move(landmarks);
  T_cw_last_ = T_cw;
  if (options_.mode != "full") return;
  if (!same_world) {
    // The camera is where it was, only the numbers have changed.
    if (T_cw && T_cw_expected_) {
      background_.ChangeWorld(T_cw_expected_->Inverse() * *T_cw);
    } else {
      background_.Forget();
    }
  }
  if (T_cw && !past_.empty())
    background_.Remember(past_.back().time_s, past_.back().depth, last_owners_, *T_cw, steady_);
}

double DynamicFilter::FeatureFactor() const {
  return std::min(options_.max_feature_factor, 1 / std::max(0.1, 1 - mask_share_));
}

SplitFeatures SplitByProbability(const FrameFeatures& features, const PointLabels& labels,
                                 double min_static_probability, const Camera& camera) {
  SplitFeatures split;
  for (int i = 0; i < features.size(); ++i) {
    const bool is_used = labels.static_probability[i] >= static_cast<float>(min_static_probability);
    FrameFeatures& part = is_used ? split.used : split.removed;
    part.Append(features, i, labels.static_probability[i]);
    if (!is_used) split.removed_from.push_back(i);
  }
  split.used.BuildGrid(camera);
  split.removed.BuildGrid(camera);
  return split;
}

}  // namespace msf
