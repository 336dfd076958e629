// Adds a thread to a single-threaded stage: items go into a bounded queue, one thread processes
// them in order.
#pragma once

#include <atomic>
#include <exception>
#include <functional>
#include <thread>
#include <utility>

#include "util/bounded_queue.h"

namespace msf {

template <typename T>
class Worker {
 public:
  Worker(size_t capacity, std::function<void(T)> process)
      : queue_(capacity), process_(std::move(process)), thread_([this] { Run(); }) {}
  ~Worker() { Close(); }

  // Waits while the queue is full.
  void Push(T item) {
    ++pending_;
    if (!queue_.Push(std::move(item))) --pending_;
  }
  // Waits until every item has at least been begun.
  void WaitUntilBegun() const { queue_.WaitUntilAtMost(0); }
  // Items that wait; the one being processed is not counted.
  int queued() const { return static_cast<int>(queue_.size()); }
  bool idle() const { return pending_ == 0; }

  // Processes what is queued and joins. Throws what `process` threw, if it did: nothing was
  // processed after that.
  void Finish() {
    Close();
    if (const std::exception_ptr failure = std::exchange(failure_, nullptr))
      std::rethrow_exception(failure);
  }

 private:
  void Close() {
    queue_.Close();
    if (thread_.joinable()) thread_.join();
  }

  void Run() {
    while (std::optional<T> item = queue_.Pop()) {
      if (!failure_) Process(std::move(*item));
      --pending_;
    }
  }

  void Process(T item) {
    try {
      process_(std::move(item));
    } catch (...) {
      failure_ = std::current_exception();
    }
  }

  BoundedQueue<T> queue_;
  std::atomic<int> pending_ = 0;
  std::function<void(T)> process_;
  std::exception_ptr failure_;  // written by the thread, read after it was joined
  std::thread thread_;          // last: it starts when all else is ready
};

}  // namespace msf
