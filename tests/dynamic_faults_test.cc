// What can go wrong with the detector and with what it looks at: the trajectory must not notice.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <limits>
#include <mutex>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "io/test_folder.h"
#include "simulation/cast.h"
#include "tests/pipeline_fixture.h"

namespace msf {
namespace {

using testing::HasSubstr;

constexpr int kNumFrames = 75;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

// A detector that does what a test wants.
class ScriptedDetector : public Detector {
 public:
  using Script = std::function<StatusOr<std::vector<Detection>>(const cv::Mat& image)>;
  explicit ScriptedDetector(Script script)
      : Detector({"person", "chair", "kettle"}, {416, 320}, "scripted"),
        script_(std::move(script)) {}

  StatusOr<Detections> DetectInImage(const cv::Mat& image) override {
    StatusOr<std::vector<Detection>> objects = script_(image);
    if (!objects.ok()) return objects.status();
    Detections detections;
    detections.objects = *std::move(objects);
    return detections;
  }
  void set_confidence(double /*confidence*/) override {}

 private:
  const Script script_;
};

Detection Person(const ImageBox& box, float score = 0.9f) { return {0, score, box}; }

// What the filter said, over a run.
class Listener : public Observer {
 public:
  void OnDynamics(const RgbdFrame& frame, const FrameFeatures& features,
                  const DynamicResult& result) override {
    max_age = std::max(max_age, result.detection_age);
    if (result.detection_age < 0) ++frames_without_detections;
    for (const DynamicObject& object : result.objects)
      num_known_objects += object.kind == ObjectKind::kKnown;
    if (!on_frame) return;
    on_frame(frame, features, result);
  }

  std::function<void(const RgbdFrame&, const FrameFeatures&, const DynamicResult&)> on_frame;
  int max_age = -1;
  int frames_without_detections = 0;
  int num_known_objects = 0;
};

// Somebody walks past the camera; rendered once for all tests.
class DynamicFaults : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    Scenario scenario;
    scenario.path.base = {3.1, 1.05, 1.45, 90, -10};
    ActorOptions walker;
    walker.stations = {{2.2, 2.15, 0}, {5.2, 2.15, 0}};
    scenario.actors = {walker};
    scenario.duration_s = kNumFrames / scenario.fps;
    StatusOr<Simulator> simulator = Simulator::Create(scenario, 1);
    MSF_CHECK(simulator.ok(), simulator.message());
    truth_ = new Trajectory(simulator->GroundTruth());
    frames_ = new std::vector<SimulatedFrame>();
    for (int i = 0; i < kNumFrames; ++i) frames_->push_back(simulator->Render(i));
  }
  static void TearDownTestSuite() {
    delete frames_;
    delete truth_;
  }

  static RgbdFramePtr FrameAt(int i) { return (*frames_)[i].frame; }
  // The walker's box in one of the rendered pictures.
  static std::vector<Detection> TrueBoxes(const cv::Mat& image) {
    std::vector<Detection> boxes;
    for (const SimulatedFrame& simulated : *frames_) {
      if (simulated.frame->color.data != image.data) continue;
      for (const VisibleActor& actor : FindVisibleActors(simulated.mask)) {
        const cv::Rect2f box = actor.box;
        boxes.push_back(Person({box.x, box.y, box.br().x, box.br().y}));
      }
    }
    return boxes;
  }

  // Runs all frames; poses into run_, what the filter said into listener_.
  void Run(ScriptedDetector::Script script,
           const std::function<RgbdFramePtr(int)>& frame_at = FrameAt,
           const SystemOptions& options = PipelineOptions(true)) {
    StatusOr<std::unique_ptr<System>> system = System::Create(
        options, *FrameAt(0)->camera, std::make_unique<ScriptedDetector>(std::move(script)));
    ASSERT_TRUE(system.ok()) << system.message();
    (*system)->AddObserver(listener_);
    for (int i = 0; i < kNumFrames; ++i) {
      const StatusOr<TrackingResult> result = (*system)->Track(frame_at(i));
      ASSERT_TRUE(result.ok()) << result.message();
      poses_ += result->T_cw.has_value();
    }
    before_finish_();
    reconstruction_ = (*system)->Finish();
  }
  double Error() const {
    Trajectory estimate;
    for (const ResolvedFrame& frame : reconstruction_.frames) {
      if (frame.T_wc && frame.map_id == reconstruction_.main_map)
        estimate.push_back({frame.time_s, *frame.T_wc});
    }
    return AbsoluteErrorOf(*truth_, estimate);
  }
  void ExpectGoodTrajectory() const {
    EXPECT_EQ(poses_, kNumFrames);
    EXPECT_EQ(reconstruction_.num_maps, 1);
    EXPECT_LT(Error(), 0.015);
  }

  static Trajectory* truth_;
  static std::vector<SimulatedFrame>* frames_;
  std::shared_ptr<Listener> listener_ = std::make_shared<Listener>();
  std::function<void()> before_finish_ = [] {};
  int poses_ = 0;
  Reconstruction reconstruction_;
};
Trajectory* DynamicFaults::truth_ = nullptr;
std::vector<SimulatedFrame>* DynamicFaults::frames_ = nullptr;

TEST_F(DynamicFaults, NoneToCompareWith) {
  Run(TrueBoxes);
  ExpectGoodTrajectory();
  EXPECT_EQ(reconstruction_.detection.num_detected, kNumFrames);
  EXPECT_EQ(reconstruction_.detection.num_failed, 0);
  EXPECT_EQ(listener_->max_age, 0);
  EXPECT_GT(listener_->num_known_objects, kNumFrames / 2);
}

// Told of a camera that is mounted on its side, the system has its detector look at turned
// pictures.
TEST_F(DynamicFaults, ACameraOnItsSide) {
  for (const double mounted_deg : {0, 90}) {
    SystemOptions options = PipelineOptions(true);
    options.detection.mounted_deg = mounted_deg;
    int turned = 0;
    Run(
        [&turned](const cv::Mat& image) -> StatusOr<std::vector<Detection>> {
          turned += image.size() == cv::Size(416, 320);  // of the network, else of the camera
          return std::vector<Detection>();
        },
        FrameAt, options);
    EXPECT_EQ(turned, mounted_deg == 0 ? 0 : kNumFrames);
  }
}

TEST_F(DynamicFaults, DetectorThrows) {
  Run([](const cv::Mat&) -> StatusOr<std::vector<Detection>> {
    throw std::runtime_error("out of memory");
  });
  ExpectGoodTrajectory();
  EXPECT_EQ(reconstruction_.detection.num_detected, kNumFrames);
  EXPECT_EQ(reconstruction_.detection.num_failed, kNumFrames);
  EXPECT_THAT(reconstruction_.detection.first_failure,
              AllOf(HasSubstr("frame 0"), HasSubstr("out of memory")));
  EXPECT_EQ(listener_->frames_without_detections, kNumFrames);
}

TEST_F(DynamicFaults, DetectorFailsEverySecondTime) {
  int calls = 0;
  Run([&](const cv::Mat& image) -> StatusOr<std::vector<Detection>> {
    if (++calls % 2 == 0) return Status::Error("busy");
    return TrueBoxes(image);
  });
  ExpectGoodTrajectory();
  EXPECT_EQ(reconstruction_.detection.num_failed, kNumFrames / 2);
  EXPECT_EQ(listener_->max_age, 1);
  EXPECT_GT(listener_->num_known_objects, kNumFrames / 2)
      << "people are followed between detections";
}

TEST_F(DynamicFaults, BoxesThatMakeNoSense) {
  Run([](const cv::Mat&) {
    return std::vector<Detection>{
        Person({kNan, 10, 200, 300}),       Person({10, 10, kInf, 300}),
        Person({100, 100, 300, 300}, kNan), Person({-500, -500, -100, -100}),
        Person({700, 500, 900, 800}),       Person({300, 300, 100, 100}),
        Person({50, 50, 50, 50}),           {-7, 0.9f, {100, 100, 300, 300}},
        {99, 0.9f, {100, 100, 300, 300}}};
  });
  ExpectGoodTrajectory();
  EXPECT_EQ(listener_->num_known_objects, 0);
  EXPECT_EQ(reconstruction_.detection.num_failed, 0);
}

TEST_F(DynamicFaults, BoxesThatReachBeyondTheImageAreCut) {
  Run([](const cv::Mat& image) {
    std::vector<Detection> boxes = TrueBoxes(image);
    for (Detection& detection : boxes) {
      detection.box.y0 -= 1e6f;
      detection.box.y1 += 1e6f;
    }
    return boxes;
  });
  ExpectGoodTrajectory();
}

TEST_F(DynamicFaults, APersonOverTheWholeImage) {
  Run([](const cv::Mat& image) {
    return std::vector<Detection>{
        Person({0, 0, static_cast<float>(image.cols), static_cast<float>(image.rows)})};
  });
  // The near part of the room is taken for the person and lost; the rest must do.
  EXPECT_EQ(poses_, kNumFrames);
  EXPECT_EQ(reconstruction_.num_maps, 1);
  EXPECT_LT(Error(), 0.1);
}

TEST_F(DynamicFaults, NobodyIsEverFound) {
  Run([](const cv::Mat&) { return std::vector<Detection>(); });
  ExpectGoodTrajectory();
  EXPECT_EQ(listener_->max_age, 0);
  EXPECT_EQ(listener_->num_known_objects, 0);
}

// The detector hangs from the sixth frame it gets until tracking is done: whoever waited for it
// would wait for long.
TEST_F(DynamicFaults, DetectorStalls) {
  std::mutex mutex;
  std::condition_variable changed;
  bool released = false;
  std::atomic<int> calls = 0;
  before_finish_ = [&] {
    const std::lock_guard lock(mutex);
    released = true;
    changed.notify_all();
  };
  SystemOptions options = PipelineOptions(false);
  options.wait_for_mapping = false;  // as with a camera; a recording waits for the detector
  const auto start = std::chrono::steady_clock::now();
  bool timed_out = false;
  Run(
      [&](const cv::Mat& image) {
        std::unique_lock lock(mutex);
        if (++calls > 5)
          timed_out = !changed.wait_for(lock, std::chrono::minutes(2), [&] { return released; }) ||
                      timed_out;
        return TrueBoxes(image);
      },
      FrameAt, options);
  EXPECT_FALSE(timed_out) << "tracking waited for the detector";
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::minutes(2));
  EXPECT_EQ(poses_, kNumFrames);
  EXPECT_LT(Error(), 0.02);
  EXPECT_TRUE(listener_->max_age > 5 || listener_->frames_without_detections > 5)
      << "the age is reported";
  EXPECT_LT(reconstruction_.detection.num_detected, kNumFrames);
}

TEST_F(DynamicFaults, NoDepthOnThePerson) {
  const auto without_depth = [](int i) {
    RgbdFrame frame = *FrameAt(i);
    frame.depth = frame.depth.clone();
    frame.depth.setTo(0, (*frames_)[i].mask != 0);
    return std::make_shared<const RgbdFrame>(frame);
  };
  int on_person = 0, removed = 0;
  listener_->on_frame = [&](const RgbdFrame& frame, const FrameFeatures& features,
                            const DynamicResult& result) {
    cv::Mat person;
    cv::erode((*frames_)[frame.id.value()].mask, person, cv::Mat::ones(9, 9, CV_8U));
    for (int i = 0; i < features.size(); ++i) {
      const Eigen::Vector2i px = features.image_px[i].cast<int>();
      if (person.at<uint8_t>(px.y(), px.x()) == 0) continue;
      ++on_person;
      removed += result.labels.static_probability[i] < 0.3f;
    }
  };
  Run(TrueBoxes, without_depth);
  ExpectGoodTrajectory();
  EXPECT_GT(removed, 0.9 * on_person) << on_person;
}

// Somebody steps before the lens: four fifths of the image for two seconds, swaying.
TEST_F(DynamicFaults, APersonCoversMostOfTheImage) {
  constexpr int kFrom = 8, kTo = 68, kCovered_px = 512;
  cv::Mat cloth(480, 700, CV_8UC3);
  cv::RNG rng(3);
  rng.fill(cloth, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(cloth, cloth, {9, 9}, 2.5);
  cv::normalize(cloth, cloth, 20, 235, cv::NORM_MINMAX);
  const auto covered = [&](int i) {
    if (i < kFrom || i >= kTo) return FrameAt(i);
    RgbdFrame frame = *FrameAt(i);
    frame.color = frame.color.clone();
    frame.depth = frame.depth.clone();
    const cv::Rect before_the_lens(0, 0, kCovered_px, 480);
    const int sway_px = cvRound(60 + 60 * std::sin(0.25 * i));
    cloth(cv::Rect(sway_px, 0, kCovered_px, 480)).copyTo(frame.color(before_the_lens));
    frame.depth(before_the_lens).setTo(0.7 * frame.camera->depth_factor);
    return RgbdFramePtr(std::make_shared<const RgbdFrame>(frame));
  };
  int calls = 0;
  Run(
      [&](const cv::Mat&) {
        const int frame = calls++;
        if (frame < kFrom || frame >= kTo) return std::vector<Detection>();
        return std::vector<Detection>{Person({0, 0, kCovered_px, 480})};
      },
      covered);
  // Where less than 100 static points are left poses may fail; none that is given is wrong.
  EXPECT_GE(poses_, kNumFrames / 2);
  EXPECT_EQ(reconstruction_.num_maps, 1);
  EXPECT_LT(Error(), 0.03);
}

TEST_F(DynamicFaults, AModelThatIsGarbageIsAnErrorNotAPlainRun) {
  const TestFolder folder;
  SystemOptions options = PipelineOptions(true);
  for (const std::string& content :
       {std::string(), std::string("not a model\n"), std::string(100000, '\xff'),
        std::string("\x08\x07\x12\x04"
                    "abcd",
                    8)}) {
    options.detector.model = folder.Write("model.onnx", content).string();
    EXPECT_THAT(System::Create(options, *FrameAt(0)->camera).message(), HasSubstr("model.onnx"))
        << content.size();
  }
  options.detector.model = (folder / "nowhere.onnx").string();
  EXPECT_THAT(System::Create(options, *FrameAt(0)->camera).message(), HasSubstr("nowhere.onnx"));
}

}  // namespace
}  // namespace msf
