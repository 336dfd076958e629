// Adds a thread to a single-threaded stage: items go into a bounded queue, one thread processes them in order.
#pragma once

#include <atomic>
#include <functional>
#include <thread>

#include "util/bounded_queue.h"

namespace msf {

template <typename T>
class Worker {
 public:
  Worker(size_t capacity, std::function<void(T)> process)
      : queue_(capacity), process_(std::move(process)), thread_([this] { Run(); }) {}
  // Processes what is queued, then joins.
  ~Worker() { Finish(); }

  void Push(T item) {
    ++pending_;
    if (!queue_.Push(std::move(item))) --pending_;
  }
  // Items that wait; the one being processed is not counted.
  int queued() const { return static_cast<int>(queue_.size()); }
  bool idle() const { return pending_ == 0; }

  // Takes no more items, processes those inside and joins.
  void Finish() {
    queue_.Close();
    if (thread_.joinable()) thread_.join();
  }

 private:
  void Run() {
    while (std::optional<T> item = queue_.Pop()) {
      process_(std::move(*item));
      --pending_;
    }
  }

  BoundedQueue<T> queue_;
  std::atomic<int> pending_ = 0;
  std::function<void(T)> process_;
  std::thread thread_;  // last: it starts when all else is ready
};

}  // namespace msf
