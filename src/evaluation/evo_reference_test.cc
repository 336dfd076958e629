// Our figures against those of evo on the same files.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "evaluation/evaluation.h"
#include "evaluation/evaluation_report.h"

namespace msf {
namespace {

namespace fs = std::filesystem;

constexpr double kTolerance = 1e-6;

fs::path SharedFolder() {
  const char* folder = std::getenv("MSF_SHARED");
  return folder != nullptr ? fs::path(folder) : fs::path(MSF_SOURCE_DIR).parent_path() / "shared";
}

// The true trajectory lies with the data set; its place depends on whether that was unpacked.
std::optional<fs::path> GroundTruthFile(const std::string& sequence) {
  for (const fs::path& file :
       {SharedFolder() / "data" / "sequences" / sequence / "groundtruth.txt",
        fs::path(MSF_SOURCE_DIR) / "build" / "data" / sequence / "groundtruth.txt"}) {
    if (fs::exists(file)) return file;
  }
  return std::nullopt;
}

void ExpectStatistics(const nlohmann::json& expected, const std::vector<double>& values,
                      double unit = 1) {
  const nlohmann::json actual = StatisticsToJson(values, unit);
  for (const auto& [name, value] : expected.items())
    EXPECT_NEAR(actual.at(name).get<double>(), value.get<double>(), kTolerance) << name;
}

class EvoReference : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    const fs::path folder = SharedFolder() / "reference";
    const std::optional<fs::path> truth_file = GroundTruthFile(GetParam());
    if (!fs::exists(folder / "evo.json") || !truth_file)
      GTEST_SKIP() << "the shared reference trajectories are not here: " << folder;
    expected_ = nlohmann::json::parse(std::ifstream(folder / "evo.json")).at(GetParam());
    truth_ = *ReadTrajectory(*truth_file);
    estimate_ = *ReadTrajectory(folder / (GetParam() + "_estimate.txt"));
  }

  nlohmann::json expected_;
  Trajectory truth_;
  Trajectory estimate_;
};

TEST_P(EvoReference, AbsoluteErrorIsEqual) {
  const Evaluation rigid = *EvaluateTrajectory("rigid", truth_, estimate_);
  ExpectStatistics(expected_.at("ate_se3"), rigid.absolute.translation_m.value);
  const Evaluation scaled =
      *EvaluateTrajectory("scaled", truth_, estimate_, {.scale = ScaleEstimation::kFree});
  ExpectStatistics(expected_.at("ate_sim3"), scaled.absolute.translation_m.value);
}

TEST_P(EvoReference, RelativeErrorIsEqual) {
  const Evaluation evaluation = *EvaluateTrajectory("rigid", truth_, estimate_);
  ExpectStatistics(expected_.at("rpe_trans_1frame"), evaluation.per_frame.translation_m.value);
  ExpectStatistics(expected_.at("rpe_angle_deg_1frame"), evaluation.per_frame.rotation_rad.value,
                   std::numbers::pi / 180);
  const RelativeError thirty = ComputeRelativeErrorOverFrames(evaluation.pairs, 30);
  ExpectStatistics(expected_.at("rpe_trans_30frames"), thirty.translation_m.value);
}

INSTANTIATE_TEST_SUITE_P(Sequences, EvoReference, testing::Values("fr1_xyz", "fr1_rpy"),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace msf
