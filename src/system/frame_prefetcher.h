// Reads frames ahead of their use on a thread of its own, so that decoding images runs beside
// tracking.
#pragma once

#include <exception>
#include <functional>
#include <optional>
#include <thread>
#include <utility>

#include "sensor/rgbd_frame.h"
#include "util/bounded_queue.h"
#include "util/status.h"

namespace msf {

class FramePrefetcher {
 public:
  // `load(i)` reads frame i in [0, count); it is called from one thread, in order. At most `ahead`
  // frames wait.
  FramePrefetcher(size_t count, size_t ahead, std::function<StatusOr<RgbdFramePtr>(size_t)> load)
      : queue_(ahead), thread_([this, count, load = std::move(load)] { Run(count, load); }) {}
  // Stops reading and joins.
  ~FramePrefetcher() {
    queue_.Close();
    thread_.join();
  }

  // The next frame, or why it could not be read; nothing after the last.
  std::optional<StatusOr<RgbdFramePtr>> Next() { return queue_.Pop(); }

 private:
  void Run(size_t count, const std::function<StatusOr<RgbdFramePtr>(size_t)>& load) {
    for (size_t i = 0; i < count; ++i) {
      if (!queue_.Push(TryToLoad(i, load))) return;
    }
    queue_.Close();
  }

  static StatusOr<RgbdFramePtr> TryToLoad(
      size_t i, const std::function<StatusOr<RgbdFramePtr>(size_t)>& load) {
    try {
      return load(i);
    } catch (const std::exception& error) {
      return Status::Error(error.what());
    }
  }

  BoundedQueue<StatusOr<RgbdFramePtr>> queue_;
  std::thread thread_;
};

}  // namespace msf
