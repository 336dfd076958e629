#include "system/system.h"

#include <algorithm>
#include <map>

#include "loop_closing/full_bundle.h"
#include "system/worker.h"
#include "tracking/camera_roll.h"
#include "tracking/hindsight.h"
#include "tracking/stamp_lag.h"
#include "tracking/tracker.h"
#include "tracking/trajectory_smoothing.h"
#include "util/data_path.h"

namespace msf {
namespace {

constexpr const char* kShippedVocabulary = "models/vocabulary.msfvoc";
constexpr size_t kMappingQueue = 8;
constexpr size_t kLoopClosingQueue = 64;
constexpr size_t kFullBundleQueue = 4;
constexpr size_t kHindsightQueue = 64;

StatusOr<std::shared_ptr<const Vocabulary>> LoadVocabulary(const std::string& file) {
  std::filesystem::path path = file;
  if (file.empty()) {
    StatusOr<std::filesystem::path> shipped = FindDataFile(kShippedVocabulary);
    if (!shipped.ok()) return shipped.status();
    path = *shipped;
  }
  StatusOr<Vocabulary> vocabulary = Vocabulary::Load(path);
  if (!vocabulary.ok()) return vocabulary.status();
  return std::make_shared<const Vocabulary>(*std::move(vocabulary));
}

}  // namespace

Status SystemOptions::Check() const {
  for (const Status& status :
       {detection.Check(), dynamic.Check(), feature.Check(), noise.Check(), tracking.Check(),
        relocalization.Check(), mapping.Check(), loop_closing.Check()}) {
    if (!status.ok()) return status;
  }
  if (WantsDetector()) return detector.Check();
  return Status::Ok();
}

// The stages and, in threaded mode, the workers that carry keyframes from one to the next.
class System::Impl {
 public:
  Impl(const SystemOptions& options, const Camera& camera,
       const std::shared_ptr<const Vocabulary>& vocabulary, std::unique_ptr<Detector> detector);
  ~Impl() { cancel_full_bundle_ = true; }

  // The filter of dynamic points; none in mode off.
  Status MakeFilter(const std::vector<std::string>& class_names);

  StatusOr<TrackingResult> Track(const RgbdFramePtr& frame);
  Status health() const;
  Reconstruction Finish();
  void AddObserver(std::shared_ptr<Observer> observer) {
    observers_.push_back(std::move(observer));
  }

 private:
  Status CheckOrder(const RgbdFrame& frame) const;
  void OfferToDetector(const RgbdFramePtr& frame, StageTimings& timings_ms);
  FrameFeatures Extract(const RgbdFrame& frame, StageTimings& timings_ms);
  DynamicResult Classify(const RgbdFramePtr& frame, const FrameFeatures& features);
  void TakePose(const TrackingResult& result);
  MappingLoad Load() const;
  void HandOn(KeyFrameId id);
  void MapKeyFrame(KeyFrameId id);
  void CloseLoops(KeyFrameId id);
  void RequestFullBundle(MapId id);
  void LookBackLater(const TrackingResult& result);
  void LookBack(std::vector<TrackedFrame> frames);
  Reconstruction Resolve(const Map& map) const;

  const SystemOptions options_;
  const std::shared_ptr<const Camera> camera_;
  OrbExtractor extractor_;
  std::unique_ptr<DynamicFilter> filter_;              // null in mode off
  std::unique_ptr<DetectionSource> detection_source_;  // null without a detector
  SharedMap map_;
  KeyFrameDatabase database_;
  Tracker tracker_;
  LocalMapper mapper_;
  LoopCloser loop_closer_;
  FullBundle full_bundle_;
  CameraRoll camera_roll_;
  TrajectoryRecorder recorder_;
  FrameDelay frame_delay_;
  Hindsight hindsight_;
  std::vector<std::shared_ptr<Observer>> observers_;
  MapId filter_map_;                 // the filter's last pose belongs to this map
  uint64_t filter_epoch_ = 0;        // in this epoch
  FrameId last_id_;                  // of the present frame
  double last_time_s_ = -1e300;      // of the present frame
  double previous_time_s_ = -1e300;  // of the one before it
  std::atomic<int> num_loops_ = 0, num_merges_ = 0;
  std::atomic<bool> cancel_full_bundle_ = false;
  // Null in deterministic mode. Declared last so that they stop before what they work on goes.
  std::unique_ptr<Worker<TrackedFrame>> hindsight_worker_;
  std::unique_ptr<Worker<MapId>> full_bundle_worker_;
  std::unique_ptr<Worker<KeyFrameId>> loop_worker_;
  std::unique_ptr<Worker<KeyFrameId>> mapping_worker_;
};

System::Impl::Impl(const SystemOptions& options, const Camera& camera,
                   const std::shared_ptr<const Vocabulary>& vocabulary,
                   std::unique_ptr<Detector> detector)
    : options_(options),
      camera_(std::make_shared<const Camera>(camera)),
      extractor_(options.feature),
      map_(Map(camera_, extractor_.levels())),
      tracker_({options.tracking, options.relocalization, options.noise, options.seed}, camera_,
               extractor_.levels(), map_, vocabulary, database_),
      mapper_(options.mapping, options.noise, map_, vocabulary),
      loop_closer_(options.loop_closing, options.noise, map_, database_, options.seed),
      full_bundle_(options.loop_closing, options.noise, map_),
      camera_roll_(options.detection.mounted_deg * M_PI / 180),
      frame_delay_(options.tracking.hindsight.after_s),
      hindsight_({*camera_, extractor_.levels(), options_.tracking, options_.noise}, map_) {
  if (detector) {
    detection_source_ = std::make_unique<DetectionSource>(std::move(detector), options.detection,
                                                          !options.deterministic);
  }
  if (options.deterministic) return;
  hindsight_worker_ = std::make_unique<Worker<TrackedFrame>>(
      kHindsightQueue, [this](const TrackedFrame& frame) { hindsight_.Match(frame); });
  full_bundle_worker_ = std::make_unique<Worker<MapId>>(kFullBundleQueue, [this](MapId id) {
    cancel_full_bundle_ = false;
    full_bundle_.Run(id, cancel_full_bundle_);
  });
  loop_worker_ = std::make_unique<Worker<KeyFrameId>>(kLoopClosingQueue,
                                                      [this](KeyFrameId id) { CloseLoops(id); });
  mapping_worker_ = std::make_unique<Worker<KeyFrameId>>(
      kMappingQueue, [this](KeyFrameId id) { MapKeyFrame(id); });
}

StatusOr<TrackingResult> System::Impl::Track(const RgbdFramePtr& frame) {
  MSF_RETURN_IF_ERROR(CheckFrame(*frame));
  MSF_RETURN_IF_ERROR(CheckOrder(*frame));
  last_id_ = frame->id;
  previous_time_s_ = last_time_s_;
  last_time_s_ = frame->time_s;

  if (options_.wait_for_mapping && mapping_worker_) mapping_worker_->WaitUntilBegun();

  StageTimings timings_ms;
  if (detection_source_) OfferToDetector(frame, timings_ms);
  const auto features = std::make_shared<const FrameFeatures>(Extract(*frame, timings_ms));
  std::shared_ptr<const FrameFeatures> used = features;
  DynamicResult dynamics;
  SplitFeatures split;
  if (filter_) {
    const StageTimer timer(timings_ms, "dynamic");
    dynamics = Classify(frame, *features);
    split = SplitByProbability(*features, dynamics.labels, options_.dynamic.min_static_probability,
                               *camera_);
    used = std::make_shared<const FrameFeatures>(std::move(split.used));
  }
  TrackingResult result;
  {
    const StageTimer timer(timings_ms, "tracking");
    result =
        tracker_.Track(frame, used, std::make_shared<const FrameFeatures>(std::move(split.removed)),
                       Load(), dynamics.T_now_last);
  }
  for (const auto& [stage, ms] : result.timings_ms) timings_ms["tracking." + stage] = ms;
  timings_ms["total"] = 0;
  for (const char* stage : {"detection", "feature", "dynamic", "tracking"}) {
    if (timings_ms.contains(stage)) timings_ms["total"] += timings_ms[stage];
  }
  result.timings_ms = std::move(timings_ms);
  if (filter_) {
    TakePose(result);
    for (const int k : result.readmitted)
      dynamics.labels.Set(split.removed_from[k], PointReason::kKnown, 1);
    for (const auto& observer : observers_) observer->OnDynamics(*frame, *features, dynamics);
  }
  recorder_.Record(result);
  if (result.new_keyframe) HandOn(*result.new_keyframe);
  LookBackLater(result);
  for (const auto& observer : observers_) observer->OnFrame(result);
  return result;
}

Status System::Impl::CheckOrder(const RgbdFrame& frame) const {
  const std::string name = "frame " + std::to_string(frame.id.value());
  if (*frame.camera != *camera_) {
    return Status::Error(name + " has another camera than the system");
  }
  if (!frame.id.valid() || frame.id <= last_id_) {
    return Status::Error(name + " comes after frame " + std::to_string(last_id_.value()) +
                         ": ids begin at 0 or later and rise");
  }
  if (!(frame.time_s > last_time_s_))
    return Status::Error(name + " is not later than the one before it");
  return Status::Ok();
}

void System::Impl::OfferToDetector(const RgbdFramePtr& frame, StageTimings& timings_ms) {
  const StageTimer timer(timings_ms, "detection");
  if (options_.wait_for_mapping) detection_source_->WaitUntilTaken();
  detection_source_->Offer(frame, camera_roll_.TurnUpright_rad());
}

FrameFeatures System::Impl::Extract(const RgbdFrame& frame, StageTimings& timings_ms) {
  const StageTimer timer(timings_ms, "feature");
  const Rigid3d T_depth_color = tracker_.PredictMotion(frame.depth_delay_s);
  if (!filter_) return extractor_.Extract(frame, T_depth_color);
  const int num_features =
      static_cast<int>(options_.feature.num_features * filter_->FeatureFactor());
  return extractor_.Extract(frame, num_features, T_depth_color);
}

DynamicResult System::Impl::Classify(const RgbdFramePtr& frame, const FrameFeatures& features) {
  const std::shared_ptr<const Detections> detections =
      detection_source_ ? detection_source_->Newest(frame->id) : nullptr;
  const double since_last_s = frame->time_s - previous_time_s_;
  const Rigid3d T_last_now = tracker_.PredictMotion(since_last_s).Inverse();
  return filter_->Classify(*frame, features, T_last_now, detections.get());
}

void System::Impl::TakePose(const TrackingResult& result) {
  if (!result.T_cw) {
    filter_->TakePose(std::nullopt, /*same_world=*/true, {});
    return;
  }
  const bool same_world = result.map_id == filter_map_ && result.epoch == filter_epoch_;
  filter_->TakePose(result.T_cw, same_world, result.landmarks);
  camera_roll_.Add(*result.T_cw, same_world);
  filter_map_ = result.map_id;
  filter_epoch_ = result.epoch;
}

MappingLoad System::Impl::Load() const {
  if (!mapping_worker_) return {};
  return {.idle = mapping_worker_->idle(), .queued = mapping_worker_->queued()};
}

void System::Impl::HandOn(KeyFrameId id) {
  if (!mapping_worker_) return MapKeyFrame(id);
  mapper_.Interrupt();
  mapping_worker_->Push(id);
}

void System::Impl::MapKeyFrame(KeyFrameId id) {
  const MappingSummary summary =
      mapper_.Process(id, [this] { return mapping_worker_ && mapping_worker_->queued() > 0; });
  for (const auto& observer : observers_) observer->OnKeyFrameMapped(id, summary);
  if (loop_worker_) {
    loop_worker_->Push(id);
  } else {
    CloseLoops(id);
  }
}

void System::Impl::CloseLoops(KeyFrameId id) {
  const LoopClosingSummary summary = loop_closer_.Process(id);
  if (summary.found == PlaceKind::kLoop) ++num_loops_;
  if (summary.found == PlaceKind::kMerge) ++num_merges_;
  if (summary.found) {
    for (const auto& observer : observers_) observer->OnPlaceRecognized(summary);
  }
  if (summary.wants_full_bundle) RequestFullBundle(*summary.wants_full_bundle);
}

void System::Impl::RequestFullBundle(MapId id) {
  cancel_full_bundle_ =
      full_bundle_worker_ != nullptr;  // a newer correction makes the one under way useless
  if (full_bundle_worker_) {
    full_bundle_worker_->Push(id);
  } else {
    full_bundle_.Run(id, cancel_full_bundle_);
  }
}

void System::Impl::LookBackLater(const TrackingResult& result) {
  if (!result.T_cw || options_.tracking.hindsight.after_s < 0) return;
  frame_delay_.Add({.id = result.frame_id,
                    .time_s = result.time_s,
                    .features = result.features,
                    .shutter_left_in = result.shutter_left_in,
                    .points = result.points,
                    .reference = result.reference,
                    .T_c_reference = result.T_c_reference});
  LookBack(frame_delay_.TakeDue());
}

void System::Impl::LookBack(std::vector<TrackedFrame> frames) {
  for (TrackedFrame& frame : frames) {
    if (hindsight_worker_) {
      hindsight_worker_->Push(std::move(frame));
    } else {
      hindsight_.Match(frame);
    }
  }
}

Status System::Impl::health() const {
  if (!mapping_worker_) return Status::Ok();
  for (const auto& [what, status] : {std::pair("mapping", mapping_worker_->health()),
                                     std::pair("loop closing", loop_worker_->health()),
                                     std::pair("bundle adjustment", full_bundle_worker_->health()),
                                     std::pair("looking back", hindsight_worker_->health())}) {
    if (!status.ok()) return Status::Error(std::string(what) + " failed: " + status.message());
  }
  return Status::Ok();
}

Reconstruction System::Impl::Finish() {
  if (mapping_worker_) {
    mapping_worker_->Finish();
    loop_worker_->Finish();
    full_bundle_worker_->Finish();
  }
  LookBack(frame_delay_.TakeAll());
  if (hindsight_worker_) hindsight_worker_->Finish();
  if (options_.final_bundle) {
    cancel_full_bundle_ = false;
    const std::vector<MapId> maps = map_.Read()->MapIds();
    for (const MapId id : maps) full_bundle_.Run(id, cancel_full_bundle_);
  }
  return Resolve(*map_.Read());
}

Reconstruction System::Impl::Resolve(const Map& map) const {
  Reconstruction result;
  result.frames = recorder_.Resolve(map);
  hindsight_.Revise(map, result.frames);
  result.frames = SmoothTrajectory(result.frames, options_.tracking.smoothing);
  if (options_.tracking.undo_stamp_lag)
    result.frames = UndoStampLag(result.frames, camera_->stamp_lag_s);
  std::map<MapId, int> frames_per_map;
  for (const ResolvedFrame& frame : result.frames) {
    if (frame.T_wc) ++frames_per_map[frame.map_id];
  }
  for (const auto& [id, count] : frames_per_map) {
    if (!result.main_map.valid() || count > frames_per_map[result.main_map]) result.main_map = id;
  }
  for (const KeyFrameId id : map.KeyFrameIds()) {
    const KeyFrame& keyframe = *map.FindKeyFrame(id);
    result.keyframes.push_back({id, keyframe.time_s, keyframe.T_cw.Inverse(), keyframe.map_id});
  }
  for (const MapPointId id : map.PointIds(result.main_map)) {
    const MapPoint& point = *map.FindPoint(id);
    result.points.push_back({point.p_w, point.color_bgr});
  }
  result.num_maps = static_cast<int>(map.MapIds().size());
  result.num_loops = num_loops_;
  result.num_merges = num_merges_;
  result.num_without_hindsight = hindsight_.num_left_out();
  if (detection_source_) result.detection = detection_source_->statistics();
  result.health = health();
  return result;
}

Status System::Impl::MakeFilter(const std::vector<std::string>& class_names) {
  if (options_.dynamic.mode == "off") return Status::Ok();
  StatusOr<std::unique_ptr<DynamicFilter>> filter = DynamicFilter::Create(
      options_.dynamic, *camera_, extractor_.levels(), class_names, options_.seed);
  if (!filter.ok()) return filter.status();
  filter_ = *std::move(filter);
  return Status::Ok();
}

StatusOr<std::unique_ptr<System>> System::Create(const SystemOptions& options,
                                                 const Camera& camera) {
  if (const Status status = options.Check(); !status.ok()) return status;
  if (!options.WantsDetector()) return Create(options, camera, nullptr);
  DetectorOptions detector_options = options.detector;
  // Weak detections may continue an object that is known already.
  detector_options.confidence =
      std::min(detector_options.confidence, options.dynamic.tracks.continue_score);
  StatusOr<std::unique_ptr<Detector>> detector = MakeDetector(detector_options);
  if (!detector.ok()) return detector.status();
  return Create(options, camera, *std::move(detector));
}

StatusOr<std::unique_ptr<System>> System::Create(const SystemOptions& options, const Camera& camera,
                                                 std::unique_ptr<Detector> detector) {
  for (const Status& status : {options.Check(), camera.Check()}) {
    if (!status.ok()) return status;
  }
  const std::string& mode = options.dynamic.mode;
  if (!detector && (mode == "boxes" || mode == "paper"))
    return Status::Error("dynamic.mode " + mode + " needs a detector, but detector.model is none");
  StatusOr<std::shared_ptr<const Vocabulary>> vocabulary = LoadVocabulary(options.vocabulary);
  if (!vocabulary.ok()) return vocabulary.status();
  const std::vector<std::string> class_names =
      detector ? detector->class_names() : std::vector<std::string>();
  auto impl = std::make_unique<Impl>(options, camera, *vocabulary, std::move(detector));
  if (const Status status = impl->MakeFilter(class_names); !status.ok()) return status;
  return std::unique_ptr<System>(new System(std::move(impl)));
}

System::System(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
System::~System() = default;

void System::AddObserver(std::shared_ptr<Observer> observer) {
  impl_->AddObserver(std::move(observer));
}

Status System::health() const { return impl_->health(); }

StatusOr<TrackingResult> System::Track(const RgbdFramePtr& frame) { return impl_->Track(frame); }

Reconstruction System::Finish() { return impl_->Finish(); }

}  // namespace msf
