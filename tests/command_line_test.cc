// The program as a user meets it: what it prints, what it writes, how it fails.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "io/test_folder.h"
#include "io/trajectory.h"
#include "tests/program.h"

namespace msf {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

Trajectory Spiral() {
  Trajectory t;
  for (int i = 0; i < 100; ++i) {
    t.push_back(
        {0.1 * i, Rigid3d(ExpRotation({0, 0, 0.02 * i}),
                          Eigen::Vector3d(std::cos(0.1 * i), std::sin(0.1 * i), 0.01 * i))});
  }
  return t;
}

TEST(CommandLine, HelpNamesTheCommands) {
  const Outcome outcome = RunProgram("--help");
  EXPECT_EQ(outcome.exit_code, 0);
  for (const char* command : {"evaluate", "simulate"})
    EXPECT_THAT(outcome.output, HasSubstr(command));
  EXPECT_NE(RunProgram("").exit_code, 0);
  EXPECT_NE(RunProgram("no-such-command").exit_code, 0);
}

TEST(CommandLine, EvaluatePrintsAndWrites) {
  const TestFolder folder;
  ASSERT_TRUE(WriteTrajectory(folder / "truth.txt", Spiral()).ok());
  Trajectory estimate = Spiral();
  for (size_t i = 0; i < estimate.size(); i += 2) {
    estimate[i].T_wc = Rigid3d(estimate[i].T_wc.rotation(),
                               estimate[i].T_wc.translation() + Eigen::Vector3d(0, 0, 0.02));
  }
  ASSERT_TRUE(WriteTrajectory(folder / "run.txt", estimate).ok());
  const std::string path = folder.path().string() + "/";
  const Outcome outcome =
      RunProgram("evaluate " + path + "truth.txt " + path + "run.txt " + path +
                 "truth.txt --frames 200 --json " + path + "e.json --plots " + path + "plots");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("50.0 %"), HasSubstr("run"), HasSubstr("truth"),
                                    HasSubstr("ATE [m]")));
  const nlohmann::json json = nlohmann::json::parse(ReadWholeFile(folder / "e.json"));
  EXPECT_NEAR(json.at("estimates").at(0).at("ate_m").at("rmse").get<double>(), 0.01, 1e-4);
  EXPECT_NEAR(json.at("estimates").at(1).at("ate_m").at("rmse").get<double>(), 0, 1e-6);
  EXPECT_TRUE(std::filesystem::exists(folder / "plots/trajectory.svg"));
  EXPECT_TRUE(std::filesystem::exists(folder / "plots/error.svg"));
}

TEST(CommandLine, EvaluateExplainsMistakes) {
  const TestFolder folder;
  ASSERT_TRUE(WriteTrajectory(folder / "truth.txt", Spiral()).ok());
  folder.Write("nan.txt", "1 0 0 0 0 0 0 1\n2 nan 0 0 0 0 0 1\n");
  folder.Write("late.txt", "1000 0 0 0 0 0 0 1\n");
  const std::string path = folder.path().string() + "/";
  const std::string truth = path + "truth.txt ";
  ExpectSentence(RunProgram("evaluate " + truth + path + "absent.txt"),
                 "absent.txt: cannot be opened");
  ExpectSentence(RunProgram("evaluate " + path + "nan.txt " + truth), "nan.txt:2: 'nan'");
  ExpectSentence(RunProgram("evaluate " + truth + path + "late.txt"), "0 of 1 poses");
  ExpectSentence(RunProgram("evaluate " + truth + truth + "--dataset " + path),
                 "rgb.txt and depth.txt");
  ExpectSentence(RunProgram("evaluate " + truth + truth + "--json " + path + "no/e.json"),
                 "no/e.json");
  EXPECT_NE(RunProgram("evaluate " + truth).exit_code, 0);
  EXPECT_NE(RunProgram("evaluate " + truth + truth + "--frames 5 --dataset " + path).exit_code, 0);
}

TEST(CommandLine, PicturesAreSeenNineWaysUpUnlessTheyAreUpright) {
  const TestFolder folder;
  ASSERT_TRUE(
      cv::imwrite((folder / "grey.png").string(), cv::Mat(48, 64, CV_8UC3, cv::Scalar(99))));
  const std::string command = "detect " + (folder / "grey.png").string();
  EXPECT_THAT(RunProgram(command).output, HasSubstr("9 ways up, also mirrored"));
  EXPECT_THAT(RunProgram(command + " --held upright").output,
              AllOf(Not(HasSubstr("ways up")), HasSubstr("also mirrored")));
  EXPECT_THAT(RunProgram(command + " --held upright --not-mirrored").output,
              Not(HasSubstr("mirrored")));
  const Outcome wrong = RunProgram(command + " --held sideways");
  EXPECT_NE(wrong.exit_code, 0);
  EXPECT_THAT(wrong.output, HasSubstr("{upright,any}"));
  ExpectSentence(RunProgram(command + " --overlap-decay -1"), "overlap_decay must not be negative");
}

TEST(CommandLine, WhatMovesIsShownLabelledAndScored) {
  const TestFolder folder;
  const std::string path = folder.path().string() + "/";
  Outcome outcome = RunProgram("simulate flying_box --frames 12 --out " + path + "data");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  const std::string run =
      "run " + path + "data --deterministic --detector none --out " + path + "out ";
  outcome = RunProgram(run + "--labels --overlay " + path + "pictures");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("dynamic      full"), HasSubstr("overlay: ")));
  EXPECT_TRUE(std::filesystem::exists(folder / "pictures/000011.jpg"));
  EXPECT_THAT(ReadWholeFile(folder / "out/frames.csv"), HasSubstr(",points_static,"));
  const nlohmann::json report = nlohmann::json::parse(ReadWholeFile(folder / "out/report.json"));
  EXPECT_GT(report.at("dynamic").at("points").at("static").get<int>(), 1000);

  outcome = RunProgram("evaluate --masks " + path + "data --labels " + path +
                       "out/labels.csv --json " + path + "e.json");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_THAT(outcome.output,
              AllOf(HasSubstr("12 frames"), HasSubstr("static points kept"), HasSubstr("box, ")));
  const nlohmann::json score =
      nlohmann::json::parse(ReadWholeFile(folder / "e.json")).at("masks").at(0);
  EXPECT_EQ(score.at("frames"), 12);
  EXPECT_GT(score.at("static").at("points").get<int>(), 1000);

  ASSERT_EQ(RunProgram(run).exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(folder / "out/labels.csv")) << "of an earlier run";
  ExpectSentence(RunProgram(run + "--dynamic off --labels"),
                 "with --dynamic off nothing is looked for");
  ExpectSentence(RunProgram("evaluate --masks " + path + "data"), "--labels");
  ExpectSentence(RunProgram("evaluate"), "name the true trajectory");
}

}  // namespace
}  // namespace msf
