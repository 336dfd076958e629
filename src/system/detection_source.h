// Where detections come from: a detector beside tracking, which never waits for it, or inline.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "detection/detector.h"
#include "sensor/rgbd_frame.h"

namespace msf {

// Which frames are detected, how they are turned and when results are handed out; other values than
// the defaults serve experiments.
struct DetectionScheduleOptions {
  int every = 1;
  int delay_frames = 0;
  bool turn_upright = true;
  double mounted_deg = 0;
  double max_load = 0;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("every", every, "only every so-manieth frame is given to the detector");
    visit("delay_frames", delay_frames, "results are held back for so many frames");
    visit("turn_upright", turn_upright,
          "the detector sees images turned upright while the camera is rolled by more than 45 "
          "degrees");
    visit("mounted_deg", mounted_deg,
          "clockwise turn by which the images of a camera that is held as usual become upright, "
          "degrees: 90 or -90 for one that is mounted on its side");
    visit("max_load", max_load,
          "share of the time that the detector may work for, since a slow one would take the "
          "second of two cores from mapping; 0: 0.6, or 1 where there are four cores or more");
  }
  Status Check() const;
};

struct DetectionStatistics {
  int64_t num_detected = 0;  // frames that went through the detector
  int64_t num_failed = 0;    // of them, those on which it failed
  std::string first_failure;
  double mean_ms = 0;  // per frame, wall time
};

// A failing detector (an error or an exception) gives no detections for that frame; it is counted,
// and the next frame is tried again.
class DetectionSource {
 public:
  // `threaded`: detection in a thread of its own behind a mailbox that holds the newest frame only;
  // else within Offer().
  DetectionSource(std::unique_ptr<Detector> detector, const DetectionScheduleOptions& options,
                  bool threaded);
  ~DetectionSource();
  DetectionSource(const DetectionSource&) = delete;
  DetectionSource& operator=(const DetectionSource&) = delete;

  // Gives the present frame to the detector, in place of one that still waits. `turn_rad`: by how
  // much it has to be turned, clockwise, to be upright.
  void Offer(const RgbdFramePtr& frame, double turn_rad = 0);
  // The newest detections; null when there are none yet. They carry the frame that they belong to.
  std::shared_ptr<const Detections> Newest(FrameId now) const;
  // Waits until the mailbox is empty: for recordings, which come faster than a camera's images.
  // Meanwhile the detector does not rest.
  void WaitUntilTaken();
  DetectionStatistics statistics() const;

 private:
  struct Task {
    RgbdFramePtr frame;  // null: none
    double turn_rad = 0;
  };

  void Run();
  // Leaves the processor to others, so that the work before takes up no more than its share, but
  // not for more than a few frames.
  void Rest(std::chrono::duration<double> after_work);
  void Detect(const Task& task);

  const std::unique_ptr<Detector> detector_;
  const DetectionScheduleOptions options_;
  const double load_;  // DetectionScheduleOptions::max_load
  int64_t num_offered_ = 0;

  mutable std::mutex mutex_;  // guards all below
  mutable std::condition_variable changed_;
  Task mailbox_;
  bool closed_ = false;
  int64_t num_posted_ = 0;                                 // frames that were put into the mailbox
  int num_waiting_ = 0;                                    // callers within WaitUntilTaken()
  std::deque<std::shared_ptr<const Detections>> results_;  // newest last
  DetectionStatistics statistics_;
  std::thread thread_;  // last: it starts when all else is ready
};

}  // namespace msf
