// The whole system on the simulated world, where the truth is exact.
#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/pipeline_fixture.h"

namespace msf {
namespace {

struct SimulatedRun {
  PipelineRun run;
  Trajectory truth;
};

Simulator MakeSimulator(const std::string& scenario_name) {
  const StatusOr<Scenario> scenario = LoadScenario(scenario_name);
  MSF_CHECK(scenario.ok(), scenario.message());
  StatusOr<Simulator> simulator = Simulator::Create(*scenario, 1);
  MSF_CHECK(simulator.ok(), simulator.message());
  return *std::move(simulator);
}

SimulatedRun RunScenario(const std::string& scenario_name, int frames,
                         const SystemOptions& options) {
  Simulator simulator = MakeSimulator(scenario_name);
  SimulatedRun result;
  result.truth = simulator.GroundTruth();
  result.run = RunPipeline(options, simulator.camera(), std::min(frames, simulator.num_frames()),
                           [&](int i) { return simulator.Render(i).frame; });
  return result;
}

TEST(Pipeline, TracksEveryFrameOfAHandHeldCamera) {
  const SimulatedRun result = RunScenario("xyz", 150, PipelineOptions(true));
  EXPECT_EQ(result.run.estimate.size(), 150u);
  EXPECT_LT(AbsoluteErrorOf(result.truth, result.run.estimate), 0.01);
  EXPECT_GT(result.run.reconstruction.points.size(), 1000u);
}

TEST(Pipeline, TracksTurningCamera) {
  const SimulatedRun result = RunScenario("rpy", 150, PipelineOptions(true));
  EXPECT_EQ(result.run.estimate.size(), 150u);
  EXPECT_LT(AbsoluteErrorOf(result.truth, result.run.estimate), 0.02);
}

TEST(Pipeline, DeterministicRunsAreEqualToTheBit) {
  const SimulatedRun a = RunScenario("xyz", 60, PipelineOptions(true));
  const SimulatedRun b = RunScenario("xyz", 60, PipelineOptions(true));
  ASSERT_EQ(a.run.estimate.size(), b.run.estimate.size());
  for (size_t i = 0; i < a.run.estimate.size(); ++i) {
    EXPECT_EQ(a.run.estimate[i].T_wc.translation(), b.run.estimate[i].T_wc.translation()) << i;
    EXPECT_EQ(a.run.estimate[i].T_wc.rotation().coeffs(),
              b.run.estimate[i].T_wc.rotation().coeffs())
        << i;
  }
}

TEST(Pipeline, ThreadsAreAsAccurate) {
  const SimulatedRun result = RunScenario("xyz", 150, PipelineOptions(false));
  EXPECT_EQ(result.run.estimate.size(), 150u);
  EXPECT_LT(AbsoluteErrorOf(result.truth, result.run.estimate), 0.01);
}

TEST(Pipeline, PoseReturnsAfterASecondOfBlackFrames) {
  Simulator simulator = MakeSimulator("xyz");
  const auto frame_at = [&](int i) {
    RgbdFrame frame = *simulator.Render(i).frame;
    if (i >= 60 && i < 90) {
      frame.color = cv::Mat::zeros(frame.color.size(), frame.color.type());
      frame.depth = cv::Mat::zeros(frame.depth.size(), frame.depth.type());
    }
    return std::make_shared<const RgbdFrame>(frame);
  };
  const PipelineRun run = RunPipeline(PipelineOptions(true), simulator.camera(), 120, frame_at);
  for (int i = 60; i < 90; ++i) EXPECT_FALSE(run.results[i].T_cw.has_value()) << i;
  for (int i = 95; i < 120; ++i) EXPECT_TRUE(run.results[i].T_cw.has_value()) << i;
  EXPECT_EQ(run.reconstruction.num_maps, 1);
  EXPECT_LT(AbsoluteErrorOf(simulator.GroundTruth(), run.estimate), 0.01);
}

TEST(Pipeline, DarknessFromTheStartGivesNoPoseAndNoCrash) {
  Simulator simulator = MakeSimulator("xyz");
  const auto frame_at = [&](int i) {
    RgbdFrame frame = *simulator.Render(i).frame;
    frame.color = cv::Mat::zeros(frame.color.size(), frame.color.type());
    return std::make_shared<const RgbdFrame>(frame);
  };
  const PipelineRun run = RunPipeline(PipelineOptions(false), simulator.camera(), 5, frame_at);
  EXPECT_TRUE(run.estimate.empty());
  EXPECT_EQ(run.reconstruction.frames.size(), 5u);
}

TEST(Pipeline, WithoutDepthThereIsNoMap) {
  Simulator simulator = MakeSimulator("xyz");
  const auto frame_at = [&](int i) {
    RgbdFrame frame = *simulator.Render(i).frame;
    frame.depth = cv::Mat::zeros(frame.depth.size(), frame.depth.type());
    return std::make_shared<const RgbdFrame>(frame);
  };
  const PipelineRun run = RunPipeline(PipelineOptions(true), simulator.camera(), 5, frame_at);
  EXPECT_TRUE(run.estimate.empty());
}

TEST(Pipeline, FramesThatDoNotFitAreRefusedAndChangeNothing) {
  Simulator simulator = MakeSimulator("xyz");
  StatusOr<std::unique_ptr<System>> system =
      System::Create(PipelineOptions(true), simulator.camera());
  ASSERT_TRUE(system.ok()) << system.message();
  const RgbdFramePtr first = simulator.Render(0).frame;
  ASSERT_TRUE((*system)->Track(first).ok());
  EXPECT_FALSE((*system)->Track(first).ok()) << "the same time twice";
  RgbdFrame small = *simulator.Render(1).frame;
  small.color = small.color(cv::Rect(0, 0, 320, 240));
  EXPECT_FALSE((*system)->Track(std::make_shared<const RgbdFrame>(small)).ok());
  RgbdFrame nameless = *simulator.Render(1).frame;
  nameless.id = FrameId();
  EXPECT_FALSE((*system)->Track(std::make_shared<const RgbdFrame>(nameless)).ok());
  RgbdFrame foreign = *simulator.Render(1).frame;
  Camera other = simulator.camera();
  other.fx += 10;
  foreign.camera = std::make_shared<const Camera>(other);
  EXPECT_FALSE((*system)->Track(std::make_shared<const RgbdFrame>(foreign)).ok());
  EXPECT_TRUE((*system)->Track(simulator.Render(1).frame).ok());
  const Reconstruction reconstruction = (*system)->Finish();
  EXPECT_EQ(reconstruction.frames.size(), 2u);
  EXPECT_TRUE(reconstruction.health.ok());
}

// Fails on the mapper's thread.
class FailingObserver : public Observer {
 public:
  void OnKeyFrameMapped(KeyFrameId /*id*/, const MappingSummary& /*summary*/) override {
    throw std::runtime_error("out of memory");
  }
};

TEST(Pipeline, WhenMappingFailsWhatWasTrackedIsKept) {
  constexpr int kFrames = 10;
  Simulator simulator = MakeSimulator("xyz");
  StatusOr<std::unique_ptr<System>> system =
      System::Create(PipelineOptions(/*deterministic=*/false), simulator.camera());
  ASSERT_TRUE(system.ok()) << system.message();
  (*system)->AddObserver(std::make_shared<FailingObserver>());
  EXPECT_TRUE((*system)->health().ok());
  for (int i = 0; i < kFrames; ++i)
    ASSERT_TRUE((*system)->Track(simulator.Render(i).frame).ok()) << i;
  const Reconstruction reconstruction = (*system)->Finish();
  EXPECT_EQ(reconstruction.health.message(), "mapping failed: out of memory");
  EXPECT_EQ((*system)->health().message(), reconstruction.health.message());
  ASSERT_EQ(reconstruction.frames.size(), kFrames);
  for (const ResolvedFrame& frame : reconstruction.frames) EXPECT_TRUE(frame.T_wc);
}

TEST(Pipeline, OptionsThatMakeNoSenseAreNamed) {
  SystemOptions options = PipelineOptions(true);
  options.dynamic.mode = "magic";
  EXPECT_NE(System::Create(options, *Camera::Preset("simulated")).message().find("magic"),
            std::string::npos);
  options = PipelineOptions(true);
  options.vocabulary = "/nowhere/words";
  EXPECT_NE(System::Create(options, *Camera::Preset("simulated")).message().find("/nowhere/words"),
            std::string::npos);
}

}  // namespace
}  // namespace msf
