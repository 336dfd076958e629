#include "system/detection_source.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <utility>

namespace msf {
namespace {

// Where the processor has too few cores for everything, tracking goes first. (Linux keeps a
// niceness for each thread.)
constexpr int kNiceness = 5;
constexpr double kLoadOnFewCores = 0.6;
constexpr unsigned kEnoughCores = 4;
// However long the work was: a detector that stalled has rested meanwhile.
constexpr int kLongestRest_frames = 3;
constexpr std::chrono::duration<double> kLongestRest = std::chrono::hours(1);  // no frames come

double LoadFor(const DetectionScheduleOptions& options) {
  if (options.max_load > 0) return options.max_load;
  return std::thread::hardware_concurrency() < kEnoughCores ? kLoadOnFewCores : 1;
}

}  // namespace

Status DetectionScheduleOptions::Check() const {
  if (every < 1 || delay_frames < 0)
    return Status::Error("detection: every must be at least 1, delay_frames not negative");
  if (!(std::abs(mounted_deg) <= 180))
    return Status::Error("detection: mounted_deg must lie between -180 and 180");
  if (!(max_load >= 0 && max_load <= 1))
    return Status::Error("detection: max_load must lie between 0 and 1");
  return Status::Ok();
}

DetectionSource::DetectionSource(std::unique_ptr<Detector> detector,
                                 const DetectionScheduleOptions& options, bool threaded)
    : detector_(std::move(detector)), options_(options), load_(LoadFor(options)) {
  if (threaded) thread_ = std::thread([this] { Run(); });
}

DetectionSource::~DetectionSource() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    changed_.notify_all();
  }
  if (thread_.joinable()) thread_.join();
}

void DetectionSource::Offer(const RgbdFramePtr& frame, double turn_rad) {
  if (num_offered_++ % options_.every != 0) return;
  const Task task{frame, options_.turn_upright ? turn_rad : 0};
  if (!thread_.joinable()) return Detect(task);
  const std::lock_guard lock(mutex_);
  mailbox_ = task;
  ++num_posted_;
  changed_.notify_all();
}

std::shared_ptr<const Detections> DetectionSource::Newest(FrameId now) const {
  const std::lock_guard lock(mutex_);
  for (auto result = results_.rbegin(); result != results_.rend(); ++result) {
    if ((*result)->frame.value() + options_.delay_frames <= now.value()) return *result;
  }
  return nullptr;
}

void DetectionSource::WaitUntilTaken() {
  std::unique_lock lock(mutex_);
  ++num_waiting_;
  changed_.notify_all();
  changed_.wait(lock, [&] { return closed_ || !mailbox_.frame; });
  --num_waiting_;
}

DetectionStatistics DetectionSource::statistics() const {
  const std::lock_guard lock(mutex_);
  return statistics_;
}

void DetectionSource::Run() {
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNiceness);
  while (true) {
    Task task;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return closed_ || mailbox_.frame; });
      if (closed_) return;
      task = std::exchange(mailbox_, {});
      changed_.notify_all();
    }
    const auto start = std::chrono::steady_clock::now();
    Detect(task);
    Rest(std::chrono::steady_clock::now() - start);
  }
}

void DetectionSource::Rest(std::chrono::duration<double> after_work) {
  std::unique_lock lock(mutex_);
  const int64_t last_frame = num_posted_ + kLongestRest_frames;
  changed_.wait_for(lock, std::min(after_work * (1 / load_ - 1), kLongestRest),
                    [&] { return closed_ || num_waiting_ > 0 || num_posted_ >= last_frame; });
}

void DetectionSource::Detect(const Task& task) {
  const auto start = std::chrono::steady_clock::now();
  StatusOr<Detections> found = Status::Error("");
  // A user's detector may throw anything; tracking goes on without it.
  try {
    found = detector_->Detect(*task.frame, task.turn_rad);
  } catch (const std::exception& failure) {
    found = Status::Error(failure.what());
  } catch (...) {
    found = Status::Error("the detector has thrown something that is not a std::exception");
  }
  const std::chrono::duration<double, std::milli> elapsed =
      std::chrono::steady_clock::now() - start;
  const std::lock_guard lock(mutex_);
  DetectionStatistics& s = statistics_;
  ++s.num_detected;
  s.mean_ms += (elapsed.count() - s.mean_ms) / static_cast<double>(s.num_detected);
  if (!found.ok()) {
    if (s.num_failed++ == 0)
      s.first_failure = "frame " + std::to_string(task.frame->id.value()) + ": " + found.message();
    return;
  }
  results_.push_back(std::make_shared<const Detections>(*std::move(found)));
  if (results_.size() > static_cast<size_t>(options_.delay_frames) + 2) results_.pop_front();
}

}  // namespace msf
