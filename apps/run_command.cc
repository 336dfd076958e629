// msf-slam run: from a dataset folder to a trajectory, a map and a report.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <iostream>
#include <map>
#include <memory>
#include <opencv2/core/utility.hpp>
#include <thread>

#include "apps/command.h"
#include "apps/dynamics_recorder.h"
#include "apps/run_arguments.h"
#include "evaluation/run_folder.h"
#include "io/tum_dataset.h"
#include "system/frame_prefetcher.h"
#include "system/system.h"
#include "util/atomic_file.h"
#include "util/options.h"
#include "util/progress.h"
#include "viewer/overlay_recorder.h"

namespace msf {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

// Decoded frames that may wait; a frame takes 1.5 MB.
constexpr size_t kFramesAhead = 4;

std::atomic<bool> interrupted = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");

// The first Ctrl-C, SIGTERM or closed terminal ends the run early with all results written; a
// second Ctrl-C or SIGTERM kills.
class InterruptGuard {
 public:
  InterruptGuard()
      : interrupt_before_(std::signal(SIGINT, &OnSignal)),
        terminate_before_(std::signal(SIGTERM, &OnSignal)),
        hangup_before_(std::signal(SIGHUP, &OnSignal)) {
    if (hangup_before_ == SIG_IGN) std::signal(SIGHUP, SIG_IGN);  // nohup wants the run to go on
  }
  ~InterruptGuard() {
    std::signal(SIGINT, interrupt_before_);
    std::signal(SIGTERM, terminate_before_);
    std::signal(SIGHUP, hangup_before_);
  }
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

 private:
  // Both the shell and the system tell of a terminal that closes: a second SIGHUP means nothing.
  static void OnSignal(int signal) {
    interrupted = true;
    std::signal(signal, signal == SIGHUP ? SIG_IGN : SIG_DFL);
  }
  void (*interrupt_before_)(int);
  void (*terminate_before_)(int);
  void (*hangup_before_)(int);
};

// The folder's own name, also when it was given as "." or by a link.
std::string NameOf(const fs::path& folder) { return ResolvePath(folder).filename().string(); }

double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Says when a frame of a recording would come out of a live camera.
class Pacer {
 public:
  Pacer(bool real_time, double first_time_s) : real_time_(real_time), first_time_s_(first_time_s) {}

  // Waits for the frame's time, or until the run is interrupted. False: it is too late, a live
  // camera has dropped it at `dropped_at_s` for want of buffers.
  bool WaitFor(double time_s, double dropped_at_s) {
    if (!real_time_) return true;
    if (DelayOf(dropped_at_s) > 0) return false;
    for (double left_s = -DelayOf(time_s); left_s > 0 && !interrupted; left_s = -DelayOf(time_s))
      std::this_thread::sleep_for(std::chrono::duration<double>(std::min(left_s, kNap_s)));
    return true;
  }
  // Seconds since the camera had the frame.
  double DelayOf(double time_s) const { return SecondsSince(start_) - (time_s - first_time_s_); }

 private:
  static constexpr double kNap_s = 0.1;  // an interrupt waits no longer

  const bool real_time_;
  const double first_time_s_;
  const Clock::time_point start_ = Clock::now();
};

struct Recording {
  std::vector<FrameRecord> frames;
  std::vector<int64_t>
      tracked_index;        // per frame: its place among those given to the system, -1 = not given
  int64_t num_tracked = 0;  // given to the system
  double time_to_first_pose_s = 0;
};

FrameRecord RecordOf(const TrackingResult& result) {
  FrameRecord record;
  record.state = ToString(result.state);
  record.num_inliers = result.num_inliers;
  record.keyframe_id = result.new_keyframe ? result.new_keyframe->value() : -1;
  record.timings_ms = result.timings_ms;
  return record;
}

class RunSession {
 public:
  RunSession(const RunArguments& arguments, const SystemOptions& options, TumDataset dataset)
      : arguments_(arguments),
        options_(options),
        dataset_(std::move(dataset)),
        name_(NameOf(dataset_.folder())),
        recorder_(std::make_shared<DynamicsRecorder>(arguments.labels)),
        system_(Require(System::Create(options, dataset_.camera()))) {
    system_->AddObserver(recorder_);
    if (arguments.overlay.empty()) return;
    overlay_ = Require(
        OverlayRecorder::Create(arguments.overlay, dataset_.camera().fps, arguments.real_time));
    system_->AddObserver(overlay_);
  }

  RunResults Run(Clock::time_point start);
  // What the run leaves behind besides its results: labels.csv and objects.csv in `folder`, and the
  // overlay.
  Status WriteRecordings(const fs::path& folder);

 private:
  size_t NumFrames() const {
    return arguments_.max_frames > 0 ? std::min(arguments_.max_frames, dataset_.size())
                                     : dataset_.size();
  }
  Recording TrackAll(Clock::time_point start);
  FrameRecord TrackOne(const StatusOr<RgbdFramePtr>& frame, Recording& recording);
  void FillPoses(const Reconstruction& reconstruction, const Recording& recording,
                 RunResults& results) const;
  void ReadGroundTruth(RunResults& results) const;
  void DescribeDynamics(const DetectionStatistics& detection, RunResults& results) const;

  const RunArguments& arguments_;
  const SystemOptions options_;
  TumDataset dataset_;
  const std::string name_;
  const std::shared_ptr<DynamicsRecorder> recorder_;
  std::shared_ptr<OverlayRecorder> overlay_;  // null when nobody wants one
  std::unique_ptr<System> system_;
};

Recording RunSession::TrackAll(Clock::time_point start) {
  Recording recording;
  const size_t count = NumFrames();
  const auto load = [this](size_t i) { return dataset_.Load(i); };
  std::unique_ptr<FramePrefetcher> prefetcher;
  if (!options_.deterministic)
    prefetcher = std::make_unique<FramePrefetcher>(count, kFramesAhead, load);
  Progress progress("run", "frames", static_cast<int>(count));
  Pacer pacer(arguments_.real_time, dataset_.time_s(0));
  for (size_t i = 0; i < count && !interrupted && system_->health().ok(); ++i) {
    const StatusOr<RgbdFramePtr> frame = prefetcher ? *prefetcher->Next() : load(i);
    const size_t pushed_out_by = i + static_cast<size_t>(arguments_.buffers);
    const double dropped_at_s = pushed_out_by < count ? dataset_.time_s(pushed_out_by)
                                                      : std::numeric_limits<double>::infinity();
    const bool is_in_time = pacer.WaitFor(dataset_.time_s(i), dropped_at_s);
    if (interrupted) break;
    recording.tracked_index.push_back(-1);
    FrameRecord record;
    if (is_in_time) {
      record = TrackOne(frame, recording);
      if (arguments_.real_time)
        record.timings_ms["delay"] = 1000 * pacer.DelayOf(dataset_.time_s(i));
    } else {
      record.state = "dropped";
    }
    record.time_s = dataset_.time_s(i);
    recording.frames.push_back(std::move(record));
    if (recording.time_to_first_pose_s == 0 &&
        recording.frames.back().state == ToString(TrackingState::kTracking)) {
      recording.time_to_first_pose_s = SecondsSince(start);
    }
    progress.Update(static_cast<int>(i) + 1);
  }
  return recording;
}

FrameRecord RunSession::TrackOne(const StatusOr<RgbdFramePtr>& frame, Recording& recording) {
  StatusOr<TrackingResult> result =
      frame.ok() ? system_->Track(*frame) : StatusOr<TrackingResult>(frame.status());
  if (!result.ok()) {
    FrameRecord missing;
    missing.state = "missing";
    missing.note = result.message();
    return missing;
  }
  recording.tracked_index.back() = recording.num_tracked++;
  FrameRecord record = RecordOf(*result);
  record.dynamics = recorder_->TakeLast();
  return record;
}

void RunSession::FillPoses(const Reconstruction& reconstruction, const Recording& recording,
                           RunResults& results) const {
  results.frames = recording.frames;
  int elsewhere = 0;
  for (size_t i = 0; i < results.frames.size(); ++i) {
    if (recording.tracked_index[i] < 0) continue;
    const ResolvedFrame& frame = reconstruction.frames[recording.tracked_index[i]];
    if (!frame.T_wc) continue;
    if (frame.map_id == reconstruction.main_map) {
      results.frames[i].T_wc = frame.T_wc;
    } else {
      ++elsewhere;
      results.frames[i].note =
          fmt::format("tracked in map {}, which was not merged", frame.map_id.value());
    }
  }
  if (elsewhere > 0) {
    results.warnings.push_back(
        fmt::format("{} frames were tracked in other maps that could not be merged with the main "
                    "one; they have no pose",
                    elsewhere));
  }
  for (const KeyFramePose& keyframe : reconstruction.keyframes) {
    if (keyframe.map_id == reconstruction.main_map)
      results.keyframes.push_back({keyframe.time_s, keyframe.T_wc});
  }
  for (const ColoredPoint& point : reconstruction.points) {
    const auto& [b, g, r] = point.color_bgr;
    results.points.push_back({point.p_w.cast<float>(), {r, g, b}});
  }
}

void RunSession::ReadGroundTruth(RunResults& results) const {
  const std::optional<fs::path> file = dataset_.ground_truth_file();
  if (!file) return;
  StatusOr<Trajectory> truth = ReadTrajectory(*file);
  if (truth.ok()) {
    results.ground_truth = *std::move(truth);
  } else {
    results.ground_truth_problem = truth.message();
  }
}

void RunSession::DescribeDynamics(const DetectionStatistics& detection, RunResults& results) const {
  results.dynamic_mode = options_.dynamic.mode;
  if (!options_.WantsDetector()) return;
  const DetectorOptions& detector = options_.detector;
  results.detector = DetectorRecord{
      fmt::format("{} ({}, {})", detector.model, detector.backend, detector.precision),
      detection.num_detected, detection.num_failed, detection.first_failure, detection.mean_ms};
}

Status RunSession::WriteRecordings(const fs::path& folder) {
  Status overlay = overlay_ ? overlay_->Finish() : Status::Ok();
  const fs::path labels = folder / "labels.csv", objects = folder / "objects.csv";
  if (arguments_.labels) {
    MSF_RETURN_IF_ERROR(WriteLabels(labels, recorder_->labels()));
    MSF_RETURN_IF_ERROR(WriteObjects(objects, recorder_->labels()));
    return overlay;
  }
  std::error_code ignored;
  for (const fs::path& of_an_earlier_run : {labels, objects})
    fs::remove(of_an_earlier_run, ignored);
  return overlay;
}

RunResults RunSession::Run(Clock::time_point start) {
  const Recording recording = TrackAll(start);
  const Reconstruction reconstruction = system_->Finish();
  RunResults results;
  results.name = name_;
  results.mode = options_.deterministic ? "deterministic"
                 : arguments_.real_time ? "real time"
                                        : "threaded";
  FillPoses(reconstruction, recording, results);
  results.num_maps = reconstruction.num_maps;
  results.num_loops = reconstruction.num_loops;
  results.num_merges = reconstruction.num_merges;
  DescribeDynamics(reconstruction.detection, results);
  if (!reconstruction.health.ok()) {
    results.failure = reconstruction.health.message();
    results.warnings.push_back(results.failure);
  }
  if (overlay_ && overlay_->num_left_out() > 0) {
    results.warnings.push_back(fmt::format(
        "the overlay lacks {} frames that could not be drawn in time", overlay_->num_left_out()));
  }
  if (reconstruction.num_without_hindsight > 0) {
    results.warnings.push_back(
        fmt::format("the first {} poses are as tracked, not those that the final map tells: there "
                    "are more frames than tracking.hindsight.max_frames",
                    reconstruction.num_without_hindsight));
  }
  results.wall_time_s = SecondsSince(start);
  results.time_to_first_pose_s = recording.time_to_first_pose_s;
  results.usage = ReadProcessUsage();
  results.interrupted = interrupted;
  results.warnings.insert(results.warnings.begin(), dataset_.warnings().begin(),
                          dataset_.warnings().end());
  YAML::Emitter yaml;
  yaml << OptionsToYaml(options_);
  results.config_yaml = std::string(yaml.c_str()) + "\n";
  YAML::Emitter camera_yaml;
  camera_yaml << OptionsToYaml(dataset_.camera());
  results.camera_yaml = std::string(camera_yaml.c_str()) + "\n";
  ReadGroundTruth(results);
  return results;
}

std::string WhyNothingWasTracked(const RunResults& results) {
  if (results.frames.empty()) return "interrupted before the first frame";
  const auto missing = [](const FrameRecord& frame) { return frame.state == "missing"; };
  if (std::all_of(results.frames.begin(), results.frames.end(), missing)) {
    return "no frame could be used; the first: " + results.frames.front().note;
  }
  return "no frame could be tracked: none shows enough texture with depth to begin a map; look at "
         "the images, and at the "
         "camera's depth_factor";
}

// Results next to a recording could be taken for a part of it, and the other way round.
void CheckOutFolder(const fs::path& out_folder, const fs::path& dataset) {
  if (ResolvePath(out_folder) != ResolvePath(dataset)) return;
  throw CommandFailure(fmt::format("--out {}: that is the data set itself; name another folder",
                                   out_folder.string()));
}

// An overlay takes the place of what is there; inside the folder of results it has one of its own.
void CheckOverlayPlace(const fs::path& overlay, const fs::path& out_folder) {
  if (overlay.empty()) return;
  const fs::path place = ResolvePath(overlay), results = ResolvePath(out_folder);
  if (std::mismatch(place.begin(), place.end(), results.begin(), results.end()).first !=
      place.end())
    return;
  throw CommandFailure(
      fmt::format("--overlay {}: the results go there as well ({}); name another place, such as {}",
                  overlay.string(), out_folder.string(), (out_folder / "overlay.mp4").string()));
}

void Run(const RunArguments& arguments) {
  const Clock::time_point start = Clock::now();
  cv::setNumThreads(1);  // two cores belong to the stages; OpenCV's pool would only disturb them
  const SystemOptions options = ResolveOptions(arguments);
  TumDataset dataset = Require(TumDataset::Open(arguments.dataset, arguments.camera));
  fs::path out_folder = arguments.out_folder;
  if (out_folder.empty()) out_folder = fs::path("out") / NameOf(arguments.dataset);
  CheckOutFolder(out_folder, arguments.dataset);
  CheckOverlayPlace(arguments.overlay, out_folder);

  RunSession session(arguments, options, std::move(dataset));
  Require(PrepareRunFolder(out_folder));
  const InterruptGuard guard;  // until all is written
  const RunResults results = session.Run(start);
  const RunReport report = MakeRunReport(results);
  const Status written = WriteRunFolder(out_folder, results, report);
  std::cout << FormatRunReport(report);
  const Status recorded = session.WriteRecordings(out_folder);
  Require(written);
  Require(recorded);
  std::cout << "results: " << out_folder.string() << "\n";
  if (!arguments.overlay.empty()) std::cout << "overlay: " << arguments.overlay.string() << "\n";
  if (!results.failure.empty()) {
    throw CommandFailure(
        fmt::format("{}; the results end after {} frames", results.failure, results.frames.size()));
  }
  if (report.num_poses == 0) throw CommandFailure(WhyNothingWasTracked(results));
}

}  // namespace

void AddRunCommand(CLI::App& app) {
  auto arguments = std::make_shared<RunArguments>();
  CLI::App* command = app.add_subcommand("run", "Track a recorded RGB-D sequence and build a map");
  DeclareRunArguments(*command, *arguments);
  command->callback([arguments] { Run(*arguments); });
}

}  // namespace msf
