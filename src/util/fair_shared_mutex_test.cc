#include "util/fair_shared_mutex.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <shared_mutex>
#include <thread>
#include <vector>

namespace msf {
namespace {

TEST(FairSharedMutex, AWriterIsAlone) {
  FairSharedMutex mutex;
  int counter = 0;  // a data race if two were in at once
  const auto add = [&] {
    for (int i = 0; i < 2000; ++i) {
      const std::unique_lock lock(mutex);
      ++counter;
    }
  };
  std::thread other(add);
  add();
  other.join();
  EXPECT_EQ(counter, 4000);
}

TEST(FairSharedMutex, ReadersShare) {
  FairSharedMutex mutex;
  const std::shared_lock mine(mutex);
  std::thread other([&] { const std::shared_lock theirs(mutex); });
  other.join();  // would never come otherwise
}

// Two threads that take it over and over take turns: each holds it until the other one is about to
// ask for it.
TEST(FairSharedMutex, WhoWaitsIsNotOvertaken) {
  constexpr int kTimes = 300;
  FairSharedMutex mutex;
  std::array<std::atomic<bool>, 2> asking, done;
  int expected = -1, overtaken = 0;  // guarded by the mutex
  const auto take_often = [&](int me) {
    const int other = 1 - me;
    for (int i = 0; i < kTimes; ++i) {
      asking[me] = true;
      const std::unique_lock lock(mutex);
      asking[me] = false;
      overtaken += expected == other;
      while (!asking[other] && !done[other]) std::this_thread::yield();
      expected = done[other] ? -1 : other;
    }
    done[me] = true;
  };
  std::thread second(take_often, 1);
  take_often(0);
  second.join();
  // Now and then one is interrupted between the flag and the mutex.
  EXPECT_LT(overtaken, kTimes / 4);
}

// A reader that comes after a waiting writer waits for it.
TEST(FairSharedMutex, ReadersDoNotKeepAWriterOut) {
  FairSharedMutex mutex;
  std::atomic<bool> stop = false;
  std::vector<std::thread> readers;
  for (int i = 0; i < 3; ++i) {
    readers.emplace_back([&] {
      while (!stop) {
        const std::shared_lock lock(mutex);
        std::this_thread::yield();
      }
    });
  }
  { const std::unique_lock lock(mutex); }  // would never come in otherwise
  stop = true;
  for (std::thread& reader : readers) reader.join();
}

}  // namespace
}  // namespace msf
