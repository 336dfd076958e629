// A shared mutex that goes to those who wait in the order in which they came.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>

namespace msf {

// For std::unique_lock (one writer) and std::shared_lock (many readers). With std::shared_mutex a
// thread that takes it over and over, like a mapper that goes from keyframe to keyframe, is faster
// than those it wakes: they have been seen waiting for 50 ms. Not recursive, also for readers.
class FairSharedMutex {
 public:
  void lock() {
    std::unique_lock guard(mutex_);
    AwaitTurn(guard);
    changed_.wait(guard, [this] { return num_readers_ == 0; });
  }

  void unlock() { PassTurn(std::unique_lock(mutex_)); }

  void lock_shared() {
    std::unique_lock guard(mutex_);
    AwaitTurn(guard);
    ++num_readers_;
    PassTurn(std::move(guard));
  }

  void unlock_shared() {
    const std::lock_guard guard(mutex_);
    if (--num_readers_ == 0) changed_.notify_all();
  }

 private:
  void AwaitTurn(std::unique_lock<std::mutex>& guard) {
    const uint64_t turn = next_turn_++;
    changed_.wait(guard, [this, turn] { return turn_ == turn; });
  }

  void PassTurn(std::unique_lock<std::mutex> guard) {
    ++turn_;
    guard.unlock();
    changed_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  uint64_t next_turn_ = 0;
  uint64_t turn_ = 0;  // a writer's lasts until it is done
  int num_readers_ = 0;
};

}  // namespace msf
