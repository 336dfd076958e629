#include "system/detection_source.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <semaphore>
#include <stdexcept>
#include <vector>

namespace msf {
namespace {

// Asks the test what to find. Frames carry their number as the grey value of their only pixel.
class ScriptedDetector : public Detector {
 public:
  using Script = std::function<StatusOr<Detections>(int frame)>;
  explicit ScriptedDetector(Script script)
      : Detector({"person"}, {1, 1}, "scripted"), script_(std::move(script)) {}
  StatusOr<Detections> DetectInImage(const cv::Mat& image) override {
    return script_(image.at<uint8_t>(0, 0));
  }
  void set_confidence(double) override {}

 private:
  Script script_;
};

std::unique_ptr<Detector> Scripted(ScriptedDetector::Script script) {
  return std::make_unique<ScriptedDetector>(std::move(script));
}

RgbdFramePtr MakeFrame(int number) {
  auto frame = std::make_shared<RgbdFrame>();
  frame->id = FrameId(number);
  frame->time_s = 0.1 * number;
  frame->color = cv::Mat(1, 1, CV_8U, cv::Scalar(number));
  return frame;
}

// The frame of the newest detections; -1 when there are none.
int64_t NewestFrame(const DetectionSource& source, int now) {
  const std::shared_ptr<const Detections> newest = source.Newest(FrameId(now));
  return newest ? newest->frame.value() : -1;
}

StatusOr<Detections> OnePerson(int frame) {
  Detections found;
  found.objects.push_back({0, 0.01f * static_cast<float>(frame), {0, 0, 1, 1}});
  return found;
}

TEST(DetectionSchedule, Check) {
  EXPECT_TRUE(DetectionScheduleOptions().Check().ok());
  EXPECT_FALSE((DetectionScheduleOptions{.every = 0}.Check().ok()));
  EXPECT_FALSE((DetectionScheduleOptions{.delay_frames = -1}.Check().ok()));
  EXPECT_TRUE((DetectionScheduleOptions{.mounted_deg = -90}.Check().ok()));
  EXPECT_FALSE((DetectionScheduleOptions{.mounted_deg = 181}.Check().ok()));
  EXPECT_FALSE((DetectionScheduleOptions{.max_load = 1.1}.Check().ok()));
}

TEST(DetectionSource, InlineTheResultIsThereAtOnce) {
  DetectionSource source(Scripted(OnePerson), {}, false);
  EXPECT_EQ(source.Newest(FrameId(0)), nullptr);
  for (int i = 0; i < 5; ++i) {
    source.Offer(MakeFrame(i));
    const std::shared_ptr<const Detections> newest = source.Newest(FrameId(i));
    ASSERT_NE(newest, nullptr);
    EXPECT_EQ(newest->frame, FrameId(i));
    EXPECT_DOUBLE_EQ(newest->time_s, 0.1 * i);
    ASSERT_EQ(newest->objects.size(), 1u);
    EXPECT_FLOAT_EQ(newest->objects[0].score, 0.01f * static_cast<float>(i));
  }
  EXPECT_EQ(source.statistics().num_detected, 5);
  EXPECT_EQ(source.statistics().num_failed, 0);
  source.WaitUntilTaken();  // nothing waits
}

// A detector of 8x8 pixels that tells whether left or top of what it sees is bright.
class SideDetector : public Detector {
 public:
  SideDetector() : Detector({"left", "top"}, {8, 8}, "sides") {}
  StatusOr<Detections> DetectInImage(const cv::Mat& image) override {
    Detections found;
    const bool left = image.at<uint8_t>(4, 1) > 128, top = image.at<uint8_t>(1, 4) > 128;
    if (left) found.objects.push_back({0, 1, {0, 2, 3, 6}});
    if (top) found.objects.push_back({1, 1, {2, 0, 6, 3}});
    return found;
  }
  void set_confidence(double) override {}
};

TEST(DetectionSource, ARolledFrameIsTurnedUpright) {
  auto frame = std::make_shared<RgbdFrame>();
  frame->id = FrameId(0);
  frame->color = cv::Mat(8, 8, CV_8U, cv::Scalar(0));
  frame->color(cv::Rect(0, 2, 3, 4)) = cv::Scalar(255);  // left
  for (const bool turn_upright : {true, false}) {
    DetectionSource source(std::make_unique<SideDetector>(), {.turn_upright = turn_upright}, false);
    source.Offer(frame, M_PI / 2);
    const std::shared_ptr<const Detections> newest = source.Newest(FrameId(0));
    ASSERT_EQ(newest->objects.size(), 1u);
    EXPECT_EQ(newest->objects[0].class_id, turn_upright ? 1 : 0);
    // The place is that in the frame.
    EXPECT_NEAR(newest->objects[0].box.x0, 0, 1e-5);
    EXPECT_NEAR(newest->objects[0].box.y1, 6, 1e-5);
  }
}

TEST(DetectionSource, OnlyEverySoManiethFrame) {
  std::vector<int> seen;
  DetectionSource source(Scripted([&](int frame) {
                           seen.push_back(frame);
                           return OnePerson(frame);
                         }),
                         {.every = 3}, false);
  std::vector<int64_t> newest;
  for (int i = 0; i < 7; ++i) {
    source.Offer(MakeFrame(i));
    newest.push_back(NewestFrame(source, i));
  }
  EXPECT_EQ(seen, (std::vector<int>{0, 3, 6}));
  EXPECT_EQ(newest, (std::vector<int64_t>{0, 0, 0, 3, 3, 3, 6}));
}

TEST(DetectionSource, ResultsAreHeldBack) {
  DetectionSource source(Scripted(OnePerson), {.delay_frames = 2}, false);
  std::vector<int64_t> newest;
  for (int i = 0; i < 6; ++i) {
    source.Offer(MakeFrame(i));
    newest.push_back(NewestFrame(source, i));
  }
  EXPECT_EQ(newest, (std::vector<int64_t>{-1, -1, 0, 1, 2, 3}));
}

TEST(DetectionSource, SparseResultsAreHeldBack) {
  DetectionSource source(Scripted(OnePerson), {.every = 2, .delay_frames = 3}, false);
  std::vector<int64_t> newest;
  for (int i = 0; i < 8; ++i) {
    source.Offer(MakeFrame(i));
    newest.push_back(NewestFrame(source, i));
  }
  EXPECT_EQ(newest, (std::vector<int64_t>{-1, -1, -1, 0, 0, 2, 2, 4}));
}

// Frame 1 gives an error, 2 an exception, 3 something that is no exception at all.
StatusOr<Detections> Unreliable(int frame) {
  if (frame == 1) return Status::Error("out of order");
  if (frame == 2) throw std::runtime_error("broken");
  if (frame == 3) throw 42;  // NOLINT(hicpp-exception-baseclass)
  return OnePerson(frame);
}

TEST(DetectionSource, AFailureIsCountedAndTheNextFrameTriedAgain) {
  DetectionSource source(Scripted(Unreliable), {}, false);
  std::vector<int64_t> newest;
  for (int i = 0; i < 5; ++i) {
    source.Offer(MakeFrame(i));
    newest.push_back(NewestFrame(source, i));
  }
  EXPECT_EQ(newest, (std::vector<int64_t>{0, 0, 0, 0, 4}));
  EXPECT_EQ(source.statistics().num_detected, 5);
  EXPECT_EQ(source.statistics().num_failed, 3);
  EXPECT_EQ(source.statistics().first_failure, "frame 1: out of order");
}

TEST(DetectionSource, TheMessageOfAnExceptionIsKept) {
  DetectionSource source(Scripted(Unreliable), {}, false);
  source.Offer(MakeFrame(2));
  EXPECT_EQ(source.statistics().first_failure, "frame 2: broken");
}

TEST(DetectionSource, AFailureDoesNotEndTheThread) {
  DetectionSource source(Scripted(Unreliable), {}, true);
  // A frame is taken only when the one before is done.
  for (int i = 0; i < 6; ++i) {
    source.Offer(MakeFrame(i));
    source.WaitUntilTaken();
  }
  EXPECT_GE(source.statistics().num_detected, 5);
  EXPECT_EQ(source.statistics().num_failed, 3);
  EXPECT_GE(NewestFrame(source, 5), 4);
}

TEST(DetectionSource, OfTheWaitingFramesTheNewestWins) {
  std::counting_semaphore<> go(0);
  std::vector<int> seen;
  {
    const auto detect = [&](int frame) {
      seen.push_back(frame);
      go.acquire();
      return OnePerson(frame);
    };
    DetectionSource source(Scripted(detect), {}, true);
    source.Offer(MakeFrame(0));
    source.WaitUntilTaken();
    for (int i = 1; i <= 3; ++i) source.Offer(MakeFrame(i));
    EXPECT_EQ(source.Newest(FrameId(3)), nullptr) << "the detector is still busy with frame 0";
    go.release();
    source.WaitUntilTaken();  // 0 is done, 3 is taken: 1 and 2 are gone
    EXPECT_EQ(NewestFrame(source, 3), 0);
    source.Offer(MakeFrame(4));
    go.release();
    source.WaitUntilTaken();
    EXPECT_EQ(NewestFrame(source, 4), 3);
    EXPECT_EQ(NewestFrame(source, 2), 0) << "a result is never newer than the frame that asks";
    EXPECT_EQ(source.statistics().num_detected, 2);
    go.release();
  }
  EXPECT_EQ(seen, (std::vector<int>{0, 3, 4})) << "what was begun is finished";
}

// After a microsecond of work the thread would rest for a quarter of an hour.
constexpr double kTinyLoad = 1e-9;

TEST(DetectionSource, RestsAfterItsWork) {
  std::vector<int> seen;
  {
    const auto detect = [&](int frame) {
      seen.push_back(frame);
      return OnePerson(frame);
    };
    DetectionSource source(Scripted(detect), {.max_load = kTinyLoad}, true);
    source.Offer(MakeFrame(0));
    while (source.statistics().num_detected == 0) std::this_thread::yield();
    source.Offer(MakeFrame(1));
  }  // the end does not wait for a rest, either
  EXPECT_EQ(seen, std::vector<int>{0});
}

TEST(DetectionSource, DoesNotRestForManyFrames) {
  DetectionSource source(Scripted(OnePerson), {.max_load = kTinyLoad}, true);
  for (int i = 0; source.statistics().num_detected < 3; ++i) {
    source.Offer(MakeFrame(i));
    std::this_thread::yield();
  }
}

TEST(DetectionSource, DoesNotRestWhileSomebodyWaits) {
  DetectionSource source(Scripted(OnePerson), {.max_load = kTinyLoad}, true);
  for (int i = 0; i < 5; ++i) {
    source.Offer(MakeFrame(i));
    source.WaitUntilTaken();
  }
  EXPECT_GE(source.statistics().num_detected, 4);
}

}  // namespace
}  // namespace msf
