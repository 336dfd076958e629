#include "system/worker.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "system/frame_prefetcher.h"

namespace msf {
namespace {

TEST(Worker, ProcessesEverythingInOrderBeforeItFinishes) {
  std::vector<int> seen;
  Worker<int> worker(2, [&](int item) { seen.push_back(item); });
  for (int i = 0; i < 50; ++i) worker.Push(i);
  worker.Finish();
  ASSERT_EQ(seen.size(), 50u);
  for (int i = 0; i < 50; ++i) EXPECT_EQ(seen[i], i);
  EXPECT_TRUE(worker.idle());
}

TEST(Worker, AFailureIsToldAndEndsTheWork) {
  int processed = 0;
  Worker<int> worker(8, [&](int item) {
    ++processed;
    if (item == 1) throw std::runtime_error("broken");
  });
  EXPECT_TRUE(worker.health().ok());
  for (int i = 0; i < 4; ++i) worker.Push(i);
  worker.Finish();
  EXPECT_EQ(worker.health().message(), "broken");
  EXPECT_EQ(processed, 2) << "nothing is processed after a failure";
}

TEST(Worker, WaitUntilBegunReturnsWhenNothingWaits) {
  Worker<int> worker(8, [](int) {});
  for (int i = 0; i < 4; ++i) worker.Push(i);
  worker.WaitUntilBegun();
  EXPECT_EQ(worker.queued(), 0);
}

TEST(FramePrefetcher, HandsOutAllFramesAndThenNothing) {
  const auto load = [](size_t i) -> StatusOr<RgbdFramePtr> {
    if (i == 2) return Status::Error("damaged");
    auto frame = std::make_shared<RgbdFrame>();
    frame->id = FrameId(static_cast<int64_t>(i));
    return RgbdFramePtr(frame);
  };
  FramePrefetcher prefetcher(5, 2, load);
  for (int i = 0; i < 5; ++i) {
    const std::optional<StatusOr<RgbdFramePtr>> frame = prefetcher.Next();
    ASSERT_TRUE(frame.has_value());
    EXPECT_EQ(frame->ok(), i != 2);
    if (!frame->ok()) continue;
    EXPECT_EQ((**frame)->id, FrameId(i));
  }
  EXPECT_FALSE(prefetcher.Next().has_value());
}

TEST(FramePrefetcher, AnExceptionIsAFrameThatCannotBeRead) {
  const auto load = [](size_t) -> StatusOr<RgbdFramePtr> { throw std::runtime_error("too large"); };
  FramePrefetcher prefetcher(1, 2, load);
  const std::optional<StatusOr<RgbdFramePtr>> frame = prefetcher.Next();
  ASSERT_TRUE(frame.has_value());
  EXPECT_EQ(frame->message(), "too large");
}

TEST(FramePrefetcher, CanBeLeftBeforeTheEnd) {
  const auto load = [](size_t) -> StatusOr<RgbdFramePtr> {
    return RgbdFramePtr(std::make_shared<RgbdFrame>());
  };
  FramePrefetcher prefetcher(1000, 2, load);
  EXPECT_TRUE(prefetcher.Next().has_value());
}

}  // namespace
}  // namespace msf
