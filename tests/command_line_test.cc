// The program as a user meets it: what it prints, what it writes, how it fails.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <tuple>

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
  const Outcome version = RunProgram("--version");
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_THAT(version.output, AllOf(HasSubstr("msf-slam "), HasSubstr(", commit ")));
}

TEST(CommandLine, HelpShowsNumbersAsAUserWritesThem) {
  for (const char* command : {"run", "simulate", "bench", "bench compare", "evaluate"}) {
    const Outcome help = RunProgram(std::string(command) + " --help");
    EXPECT_EQ(help.exit_code, 0);
    for (const char* noise : {"999999999999", "000000000000", "e+308"})
      EXPECT_THAT(help.output, Not(HasSubstr(noise))) << command;
  }
}

TEST(CommandLine, NumbersOutOfRangeAreRefusedByTheNameOfTheirOption) {
  for (const auto& [arguments, option, number] :
       {std::tuple("run data", "--seed", "-1"),
        {"run data", "--seed", "18446744073709551616"},
        {"run data", "--max-frames", "-3"},
        {"simulate xyz --out data", "--seed", "-1"},
        {"simulate xyz --out data", "--frames", "0"},
        {"train-vocabulary data --out file", "--seed", "-1"},
        {"detector evaluate --data data", "--limit", "-1"},
        {"detector evaluate --data data", "--false-per-image", "-1"},
        {"detector evaluate --data data", "--false-per-image", "nan"},
        {"detector quantize model --images data --out file", "--count", "0"},
        {"detector quantize model --images data --out file", "--count", "-3"},
        {"detector quantize model --images data --out file", "--higher-share", "nan"},
        {"detector time", "--threads", "1000000"},
        {"detector info model", "--width", "33"},
        {"bench compare a b", "--tolerance", "nan"},
        {"bench simulated", "--time-limit", "-5"}}) {
    const Outcome outcome = RunProgram(std::string(arguments) + " " + option + " " + number);
    EXPECT_NE(outcome.exit_code, 0) << outcome.output;
    EXPECT_THAT(outcome.output, AllOf(HasSubstr(std::string(option) + ": "), HasSubstr(number),
                                      Not(HasSubstr("internal error"))));
    EXPECT_LT(outcome.output.size(), 300u) << outcome.output;
  }
  for (const char* size : {"4294967712x320", "416x-320", "416", "416x320x", "0x0", "16x16"})
    ExpectSentence(RunProgram(std::string("detector time --size ") + size), "32 to 4096 pixels");
}

TEST(CommandLine, WhereNothingCanBeWrittenIsFoundBeforeTheWork) {
  const TestFolder folder;
  folder.Write("file", "");
  const std::string path = folder.path().string() + "/";
  // What would be worked on does not exist, so the work does not get far.
  for (const std::string& command :
       {"detector evaluate --data none --json " + path + "no/e.json",
        "detector evaluate --data none --plots " + path + "file/plots",
        "detector evaluate --data none --overlay " + path + "file",
        "detector quantize none --images none --out " + path + "no/q.onnx",
        "detector time --model none --json " + path + "no/t.json",
        "train-vocabulary none --out " + path + "no/v.msfvoc",
        "evaluate none none --json " + path + "no/e.json",
        "evaluate none none --plots " + path + "file/plots"}) {
    ExpectSentence(RunProgram(command), "cannot be written: ");
  }
  ExpectSentence(RunProgram("evaluate none none --json " + path), "it is a folder; name a file");
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
  Trajectory far = Spiral();
  for (StampedPose& pose : far)
    pose.T_wc = Rigid3d(pose.T_wc.rotation(), Eigen::Vector3d(1e200 * pose.T_wc.translation()));
  ASSERT_TRUE(WriteTrajectory(folder / "far.txt", far).ok());
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
  ExpectSentence(RunProgram("evaluate " + truth + path + "far.txt --plots " + path + "plots"),
                 "far: the errors are no finite numbers");
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
  for (const char* option :
       {"dynamic.mask.grow_px=1001", "dynamic.background.num_views=101",
        "dynamic.planes.hypotheses=10001", "dynamic.flow.levels=9", "dynamic.flow.window_px=103"}) {
    const std::string key = std::string(option).substr(0, std::string(option).find('='));
    ExpectSentence(RunProgram(run + "--set " + option), key.substr(key.find('.') + 1));
  }
  ExpectSentence(RunProgram(run + "--config " + path + "data"), "data: is a folder");
  ExpectSentence(RunProgram("evaluate --masks " + path + "data"), "--labels");
  ExpectSentence(RunProgram("evaluate"), "name the true trajectory");
}

}  // namespace
}  // namespace msf
