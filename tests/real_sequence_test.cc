// A gate on real data: the first seconds of TUM fr1_xyz, when the data is at hand (folder in
// MSF_SEQUENCES, or unpacked by tests/CMakeLists.txt).
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/pipeline_fixture.h"

namespace msf {
namespace {

constexpr int kFrames = 200;

class RealSequenceTest : public ::testing::TestWithParam<bool> {};

TEST_P(RealSequenceTest, StartOfFr1XyzIsTrackedAccurately) {
  const std::filesystem::path folder = std::filesystem::path(MSF_SEQUENCES) / "fr1_xyz";
  if (!std::filesystem::exists(folder / "rgb.txt")) {
    GTEST_SKIP() << folder.string() << " is not there: the real gate was not run";
  }
  StatusOr<TumDataset> dataset = TumDataset::Open(folder, "tum_fr1");
  ASSERT_TRUE(dataset.ok()) << dataset.message();
  const auto frame_at = [&](int i) { return dataset->Load(i).value(); };
  const bool deterministic = GetParam();
  const PipelineRun run =
      RunPipeline(PipelineOptions(deterministic), dataset->camera(), kFrames, frame_at);
  const StatusOr<Trajectory> truth = ReadTrajectory(*dataset->ground_truth_file());
  ASSERT_TRUE(truth.ok()) << truth.message();
  EXPECT_EQ(run.estimate.size(), static_cast<size_t>(kFrames));
  EXPECT_LT(AbsoluteErrorOf(*truth, run.estimate), 0.0125);
  EXPECT_LT(FrameErrorOf(*truth, run.estimate), 0.0065);
}

INSTANTIATE_TEST_SUITE_P(Modes, RealSequenceTest, ::testing::Values(true, false),
                         [](const auto& mode) {
                           return mode.param ? "Deterministic" : "Threaded";
                         });

}  // namespace
}  // namespace msf
