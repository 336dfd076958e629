#include "evaluation/run_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "evaluation/run_folder.h"
#include "io/test_folder.h"

namespace msf {
namespace {

using testing::HasSubstr;

// Ten frames: the third's image is missing, the fourth and fifth are lost.
RunResults TenFrames() {
  RunResults results;
  results.name = "ten";
  results.mode = "deterministic";
  Trajectory truth;
  for (int i = 0; i < 10; ++i) {
    const Rigid3d pose(Eigen::Quaterniond::Identity(),
                       Eigen::Vector3d(std::sin(i), std::cos(i), 0.1 * i));
    truth.push_back({100 + 0.25 * i, pose});
    FrameRecord frame;
    frame.time_s = 100 + 0.25 * i;
    frame.state = i == 2 ? "missing" : i == 3 || i == 4 ? "lost" : "tracking";
    if (frame.state == "tracking") frame.T_wc = pose;
    if (frame.state != "missing") frame.timings_ms["feature"] = i + 1;
    if (i == 5) frame.timings_ms["relocalise"] = 7;
    frame.num_inliers = 10 * i;
    frame.keyframe_id = i == 0 ? 0 : -1;
    if (i == 2) frame.note = "rgb/2.png: is \"no\" image";
    results.frames.push_back(frame);
  }
  results.ground_truth = truth;
  results.keyframes = {truth[0]};
  results.points.resize(3);
  results.config_yaml = "seed: 1\n";
  results.wall_time_s = 0.5;
  results.usage.peak_memory_bytes = 100 << 20;
  return results;
}

TEST(RunReport, CountsStatesSpansAndCoverage) {
  const RunReport report = MakeRunReport(TenFrames());
  EXPECT_DOUBLE_EQ(report.Coverage(), 0.7);
  EXPECT_EQ(report.frames_per_state.at("lost"), 2u);
  ASSERT_EQ(report.spans.size(), 4u);
  EXPECT_EQ(report.spans[2].state, "lost");
  EXPECT_EQ(report.spans[2].first_frame, 3u);
  EXPECT_EQ(report.spans[2].last_frame, 4u);
  EXPECT_DOUBLE_EQ(report.spans[2].end_s, 101);
  ASSERT_TRUE(report.evaluation);
  EXPECT_DOUBLE_EQ(*report.evaluation->Coverage(), 0.7);
}

TEST(RunReport, TimingsCountOnlyFramesWithTheStage) {
  const RunReport report = MakeRunReport(TenFrames());
  const TimingSummary& feature = report.timings.at("feature");
  EXPECT_EQ(feature.num_frames, 9u);  // 1 2 4 5 6 7 8 9 10
  EXPECT_DOUBLE_EQ(feature.p50_ms, 6);
  EXPECT_DOUBLE_EQ(feature.max_ms, 10);
  EXPECT_NEAR(feature.p95_ms, 9.6, 1e-12);
  EXPECT_EQ(report.timings.at("relocalise").num_frames, 1u);
}

TEST(RunReport, JsonAndTextSayTheSame) {
  const RunReport report = MakeRunReport(TenFrames());
  const nlohmann::json json = RunReportToJson(report);
  EXPECT_EQ(json.at("frames").at("with_pose"), 7);
  EXPECT_EQ(json.at("peak_memory_mb"), 100);
  EXPECT_EQ(json.at("spans").size(), 4u);
  EXPECT_NEAR(json.at("evaluation").at("ate_m").at("rmse").get<double>(), 0, 1e-9);
  EXPECT_FALSE(json.contains("evaluation_problem"));
  EXPECT_THAT(FormatRunReport(report),
              AllOf(HasSubstr("70.0 %"), HasSubstr("ATE"), HasSubstr("20.0/s")));
}

TEST(RunReport, ARunWithoutTruthOrPosesIsReportedToo) {
  RunResults results = TenFrames();
  results.ground_truth.reset();
  results.ground_truth_problem = "groundtruth.txt:3: 'nan' is not a finite number";
  const RunReport without_truth = MakeRunReport(results);
  EXPECT_FALSE(without_truth.evaluation);
  EXPECT_THAT(FormatRunReport(without_truth), HasSubstr("'nan'"));
  EXPECT_THAT(RunReportToJson(without_truth).at("evaluation_problem").get<std::string>(),
              HasSubstr("'nan'"));

  RunResults lost = TenFrames();
  for (FrameRecord& frame : lost.frames) frame.T_wc.reset();
  const RunReport without_poses = MakeRunReport(lost);
  EXPECT_EQ(without_poses.Coverage(), 0);
  EXPECT_EQ(without_poses.evaluation_problem, "no frame has a pose");
  EXPECT_EQ(MakeRunReport(RunResults{}).Coverage(), 0);
}

TEST(RunReport, FramesThatCouldNotBeUsedAreAWarning) {
  const RunReport report = MakeRunReport(TenFrames());
  const std::string warning =
      "1 of 10 frames could not be used; the first is frame 2: rgb/2.png: is \"no\" image";
  EXPECT_THAT(report.warnings, testing::ElementsAre(warning));
  EXPECT_THAT(FormatRunReport(report), HasSubstr(warning));
}

TEST(RunReport, AnErrorThatDoesNotExistIsNotZero) {
  RunResults results = TenFrames();
  results.frames.erase(results.frames.begin(), results.frames.begin() + 7);  // half a second
  EXPECT_THAT(FormatRunReport(MakeRunReport(results)), HasSubstr("RPE 1 s      -, - RMSE"));
}

TEST(RunFolder, NamesNeedNotBeUtf8) {
  const TestFolder folder;
  RunResults results = TenFrames();
  results.name = "d\xff";
  const Status status = WriteRunFolder(folder.path(), results, MakeRunReport(results));
  EXPECT_TRUE(status.ok()) << status.message();
  const nlohmann::json json = nlohmann::json::parse(ReadWholeFile(folder / "report.json"));
  EXPECT_EQ(json.at("name"), "d\xef\xbf\xbd") << "the sign for what is no letter";
}

TEST(RunFolder, HoldsEveryFile) {
  const TestFolder folder;
  const RunResults results = TenFrames();
  const auto out = folder / "a/b";
  ASSERT_TRUE(WriteRunFolder(out, results, MakeRunReport(results)).ok());
  for (const char* name : {"map.ply", "trajectory.svg", "error.svg"})
    EXPECT_TRUE(std::filesystem::exists(out / name)) << name;
  EXPECT_EQ(ReadTrajectory(out / "trajectory.txt")->size(), 7u);
  EXPECT_EQ(ReadTrajectory(out / "keyframes.txt")->size(), 1u);
  EXPECT_EQ(ReadWholeFile(out / "config.yaml"), "seed: 1\n");
  EXPECT_EQ(nlohmann::json::parse(ReadWholeFile(out / "report.json")).at("keyframes"), 1);
  const std::string csv = ReadWholeFile(out / "frames.csv");
  EXPECT_THAT(csv, testing::StartsWith(
                       "frame,time_s,state,pose,inliers,keyframe_id,feature_ms,relocalise_ms,note\n"
                       "0,100.000000,tracking,1,0,0,1.000,,\n"));
  EXPECT_THAT(csv,
              HasSubstr("\n2,100.500000,missing,0,20,,,,\"rgb/2.png: is \"\"no\"\" image\"\n"));
}

TEST(RunFolder, PlotsOfAnEarlierRunDoNotStay) {
  const TestFolder folder;
  RunResults results = TenFrames();
  ASSERT_TRUE(WriteRunFolder(folder.path(), results, MakeRunReport(results)).ok());
  EXPECT_TRUE(std::filesystem::exists(folder / "error.svg"));
  results.ground_truth.reset();
  ASSERT_TRUE(WriteRunFolder(folder.path(), results, MakeRunReport(results)).ok());
  EXPECT_FALSE(std::filesystem::exists(folder / "error.svg"));
  EXPECT_FALSE(std::filesystem::exists(folder / "trajectory.svg"));
  EXPECT_TRUE(std::filesystem::exists(folder / "trajectory.txt"));
}

TEST(RunFolder, OneFileThatFailsDoesNotTakeTheOthersAlong) {
  const TestFolder folder;
  const RunResults results = TenFrames();
  std::filesystem::create_directories(folder / "out/map.ply/in_the_way");
  const Status status = WriteRunFolder(folder / "out", results, MakeRunReport(results));
  EXPECT_THAT(status.message(), HasSubstr("map.ply"));
  EXPECT_TRUE(std::filesystem::exists(folder / "out/report.json"));
  EXPECT_TRUE(std::filesystem::exists(folder / "out/trajectory.txt"));

  folder.Write("file", "");
  EXPECT_THAT(WriteRunFolder(folder / "file/out", results, MakeRunReport(results)).message(),
              HasSubstr("the results cannot be written there"));
  EXPECT_FALSE(PrepareRunFolder(folder / "file").ok());
}

}  // namespace
}  // namespace msf
