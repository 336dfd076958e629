// Adds a thread to a single-threaded stage: items go into a bounded queue, one thread processes
// them in order.
#pragma once

#include <atomic>
#include <exception>
#include <functional>
#include <string>
#include <thread>
#include <utility>

#include "util/bounded_queue.h"
#include "util/status.h"

namespace msf {

template <typename T>
class Worker {
 public:
  Worker(size_t capacity, std::function<void(T)> process)
      : queue_(capacity), process_(std::move(process)), thread_([this] { Run(); }) {}
  // What still waits is dropped.
  ~Worker() {
    dropping_ = true;
    Close();
  }

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

  // Processes what is queued and joins.
  void Finish() { Close(); }
  // An error once `process` has thrown: nothing is processed after that.
  Status health() const { return failed_ ? Status::Error(failure_) : Status::Ok(); }

 private:
  void Close() {
    queue_.Close();
    if (thread_.joinable()) thread_.join();
  }

  void Run() {
    while (std::optional<T> item = queue_.Pop()) {
      if (!failed_ && !dropping_) Process(std::move(*item));
      --pending_;
    }
  }

  void Process(T item) {
    try {
      process_(std::move(item));
    } catch (const std::exception& error) {
      Fail(error.what());
    } catch (...) {
      Fail("an unknown exception");
    }
  }

  void Fail(const std::string& why) {
    failure_ = why;
    failed_ = true;
  }

  BoundedQueue<T> queue_;
  std::atomic<int> pending_ = 0;
  std::function<void(T)> process_;
  std::string failure_;  // written once, before failed_ is set
  std::atomic<bool> failed_ = false;
  std::atomic<bool> dropping_ = false;
  std::thread thread_;  // last: it starts when all else is ready
};

}  // namespace msf
