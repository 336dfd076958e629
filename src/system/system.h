// The whole system: frames in, poses out, a map behind. The one room with threads and queues.
#pragma once

#include <memory>
#include <vector>

#include "map/shared_map.h"
#include "sensor/rgbd_frame.h"
#include "system/observer.h"
#include "system/system_options.h"
#include "tracking/trajectory_recorder.h"

namespace msf {

struct KeyFramePose {
  KeyFrameId id;
  double time_s = 0;
  Rigid3d T_wc;
  MapId map_id;
};

struct ColoredPoint {
  Eigen::Vector3d p_w;
  std::array<uint8_t, 3> color_bgr;
};

// What remains when the last frame has been seen: everything in the coordinates of the final map.
struct Reconstruction {
  // One per frame given to Track(), in order, with the pose at its time stamp: that which the final
  // map tells (TrackingOptions::hindsight), smoothed over TrackingOptions::smoothing.
  std::vector<ResolvedFrame> frames;
  // Of all maps, ascending by id, with the pose that their images show (Camera::stamp_lag_s).
  std::vector<KeyFramePose> keyframes;
  std::vector<ColoredPoint> points;  // of the main map
  MapId main_map;                    // the one with most frames
  int num_maps = 0;
  int num_loops = 0;   // loops closed
  int num_merges = 0;  // maps merged
  // The first frames of a long recording, whose poses are as tracked: there were more than
  // HindsightOptions::max_frames.
  int num_without_hindsight = 0;
  DetectionStatistics detection;
  Status health;  // see System::health()
};

class System {
 public:
  // An error (unreadable vocabulary, options or camera that make no sense) is a sentence.
  static StatusOr<std::unique_ptr<System>> Create(const SystemOptions& options,
                                                  const Camera& camera);
  // With a detector of the caller's own in place of options.detector.
  static StatusOr<std::unique_ptr<System>> Create(const SystemOptions& options,
                                                  const Camera& camera,
                                                  std::unique_ptr<Detector> detector);
  ~System();
  System(const System&) = delete;
  System& operator=(const System&) = delete;

  // Observers live at least as long as the system. To be added before the first frame.
  void AddObserver(std::shared_ptr<Observer> observer);

  // Locates the camera of one frame. Frames come in the order of time from one thread; a frame
  // whose images or camera do not fit, whose id is not greater or whose time is not later than the
  // last one's, is an error and changes nothing.
  StatusOr<TrackingResult> Track(const RgbdFramePtr& frame);

  // An error once mapping or loop closing has failed beside tracking, of which nothing but a bug or
  // a lack of memory is known to be a reason. Frames are still located, but the map grows no more.
  Status health() const;

  // Ends all work in order (mapping, loop closing), and resolves the trajectory against the final
  // map. Track() must not follow.
  Reconstruction Finish();

 private:
  class Impl;
  explicit System(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace msf
