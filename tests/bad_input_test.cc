// Input that is broken, or missing, or too much for the disk: a sentence, or survived and counted.
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <vector>

#include "io/test_folder.h"
#include "io/trajectory.h"
#include "tests/program.h"

namespace msf {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

constexpr int kFrames = 8;

// A short rendered sequence, for each test to damage.
class BadInputTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const Outcome outcome =
        RunProgram("simulate xyz --frames " + std::to_string(kFrames) + " --out " + Path("data"));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
    std::istringstream list(ReadWholeFile(folder_ / "data/associations.txt"));
    for (std::string line; std::getline(list, line);) {
      if (!line.starts_with('#')) lines_.push_back(line);
    }
    ASSERT_EQ(lines_.size(), static_cast<size_t>(kFrames));
  }

  std::string Path(const std::string& name) const { return (folder_ / name).string(); }
  std::string Color(int frame) const { return Path("data/" + Word(frame, 1)); }
  std::string Depth(int frame) const { return Path("data/" + Word(frame, 3)); }
  std::string Word(int frame, int index) const {
    std::istringstream words(lines_[frame]);
    std::string word;
    for (int i = 0; i <= index; ++i) words >> word;
    return word;
  }
  void WriteList(const std::vector<std::string>& lines) const {
    std::string text;
    for (const std::string& line : lines) text += line + "\n";
    folder_.Write("data/associations.txt", text);
  }
  // Gives the frames other time stamps.
  void WriteStamps(const std::function<std::string(int frame)>& stamp) const {
    std::vector<std::string> lines;
    for (int i = 0; i < kFrames; ++i) {
      std::ostringstream line;
      line << stamp(i) << ' ' << Word(i, 1) << ' ' << stamp(i) << ' ' << Word(i, 3);
      lines.push_back(line.str());
    }
    WriteList(lines);
  }
  void ChangeImage(const std::string& file, const std::function<void(cv::Mat&)>& change) const {
    cv::Mat image = cv::imread(file, cv::IMREAD_UNCHANGED);
    change(image);
    ASSERT_TRUE(cv::imwrite(file, image));
  }

  Outcome Run(const std::string& arguments = "") const {
    return RunProgram("run " + Path("data") + " --out " + Path("out") + " " + arguments);
  }
  // A run at the pace of the time stamps that gets a signal after five seconds.
  Outcome RunAndSend(const std::string& signal) const {
    // In the foreground, or else it sends the signal twice, and the second one kills.
    return RunShell("timeout --foreground --preserve-status -k 30 -s " + signal +
                    " 5 " MSF_PROGRAM " run " + Path("data") + " --realtime --out " + Path("out"));
  }
  nlohmann::json Report() const {
    return nlohmann::json::parse(ReadWholeFile(folder_ / "out/report.json"));
  }

  const TestFolder folder_;
  std::vector<std::string> lines_;
};

TEST_F(BadInputTest, FramesThatCannotBeUsedAreLeftOutAndCounted) {
  fs::remove(Color(1));
  fs::resize_file(Color(2), fs::file_size(Color(2)) / 2);
  fs::resize_file(Depth(3), 20);
  fs::resize_file(Depth(4), 0);
  ChangeImage(Color(5), [](cv::Mat& image) { cv::resize(image, image, {320, 240}); });
  ChangeImage(Depth(6), [](cv::Mat& image) { image.convertTo(image, CV_8U, 1.0 / 256); });
  const Outcome outcome = Run();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_THAT(outcome.output,
              HasSubstr("6 of 8 frames could not be used; the first is frame 1: " + Color(1)));
  EXPECT_EQ(Report().at("frames").at("by_state").at("missing"), 6);
  EXPECT_THAT(Report().at("warnings").dump(), HasSubstr("6 of 8 frames could not be used"));
  const std::string csv = ReadWholeFile(folder_ / "out/frames.csv");
  for (const std::string& why :
       {Color(1) + ": cannot be opened", Color(2) + ": is no image or a damaged one",
        Depth(3) + ": is no image or a damaged one", Depth(4) + ": the file is empty",
        Color(5) + ": the image has 320x240 pixels", Depth(6) + ": a depth image is 16-bit"})
    EXPECT_THAT(csv, HasSubstr(why));
}

TEST_F(BadInputTest, ImagesThatClaimToBeHugeAreDamagedOnes) {
  // The beginning of a PNG of 200000 x 200000 pixels with transparency.
  const std::string png(
      "\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\x03\x0d\x40\0\x03\x0d\x40\x08\x06\0\0\0\xf9\x3b\x88\x0a",
      33);
  folder_.Write("data/" + Word(2, 1), png);
  folder_.Write("data/" + Word(3, 3), png);
  for (const char* mode : {"", "--deterministic"}) {
    const Outcome outcome = Run(mode);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    EXPECT_THAT(outcome.output,
                HasSubstr("2 of 8 frames could not be used; the first is frame 2: " + Color(2) +
                          ": is no image or a damaged one"));
  }
}

TEST_F(BadInputTest, ASequenceWithoutAnyUsableFrameIsAFailure) {
  for (int i = 0; i < kFrames; ++i) {
    ChangeImage(Depth(i), [](cv::Mat& image) { image.convertTo(image, CV_8U, 1.0 / 256); });
  }
  ExpectSentence(Run(), "no frame could be used; the first: " + Depth(0) + ": a depth image is");
  EXPECT_EQ(Report().at("frames").at("by_state").at("missing"), kFrames);
}

TEST_F(BadInputTest, WithoutLightOrDepthNothingIsTracked) {
  for (int i = 0; i < kFrames; ++i) ChangeImage(Depth(i), [](cv::Mat& image) { image = 0; });
  ExpectSentence(Run(), "no frame could be tracked: none shows enough texture with depth");
  EXPECT_THAT(Report().at("evaluation_problem").get<std::string>(), HasSubstr("no frame"));
  for (int i = 0; i < kFrames; ++i) ChangeImage(Color(i), [](cv::Mat& image) { image = 0; });
  ExpectSentence(Run("--deterministic"), "no frame could be tracked");
  EXPECT_EQ(Report().at("frames").at("input"), kFrames);
}

TEST_F(BadInputTest, SomeBlackFramesAreLostOnly) {
  for (const int i : {4, 5}) ChangeImage(Color(i), [](cv::Mat& image) { image = 0; });
  EXPECT_EQ(Run("--deterministic").exit_code, 0);
  EXPECT_EQ(Report().at("frames").at("with_pose"), kFrames - 2);
}

TEST_F(BadInputTest, FramesTooManyForHindsightAreToldOf) {
  EXPECT_EQ(Run("--set tracking.hindsight.max_frames=3").exit_code, 0);
  EXPECT_THAT(Report().at("warnings").dump(), HasSubstr("the first 5 poses are as tracked"));
}

TEST_F(BadInputTest, FramesThatComeTooFastWaitInTheCamerasBuffersOrAreDropped) {
  WriteStamps([](int frame) { return "1000.00000" + std::to_string(frame); });
  const auto by_state = [&](int buffers) {
    EXPECT_EQ(Run("--realtime --buffers " + std::to_string(buffers)).exit_code, 0);
    return Report().at("frames").at("by_state");
  };
  EXPECT_FALSE(by_state(kFrames).contains("dropped"));
  EXPECT_THAT(ReadWholeFile(folder_ / "out/frames.csv"), HasSubstr("delay_ms"));
  EXPECT_GT(by_state(1).at("dropped"), 0);
  EXPECT_THAT(Run("--buffers 2").output, HasSubstr("--buffers requires --realtime"));
}

TEST_F(BadInputTest, ListsAreSortedAndRepeatedOrSenselessLinesLeftOut) {
  std::vector<std::string> lines(lines_.rbegin(), lines_.rend());
  lines.push_back(lines_[3]);
  lines.push_back("nan rgb/x.png nan depth/x.png");
  WriteList(lines);
  EXPECT_EQ(Run().exit_code, 0);
  EXPECT_EQ(Report().at("frames").at("input"), kFrames);
  EXPECT_EQ(Report().at("frames").at("with_pose"), kFrames);
  const std::string warnings = Report().at("warnings").dump();
  for (const char* what : {"out of order", "1 line with a repeated time stamp", "first is line 10"})
    EXPECT_THAT(warnings, HasSubstr(what));
}

TEST_F(BadInputTest, WhatIsNoDataSetIsRefused) {
  const auto expect_refused = [&](const std::string& what) {
    ExpectSentence(Run(), what);
    EXPECT_FALSE(fs::exists(folder_ / "out"));
  };
  for (const std::string& content :
       {std::string(), std::string("# nothing\n"), std::string("\0\xff\n", 3)}) {
    folder_.Write("data/associations.txt", content);
    expect_refused("associations.txt: has no line of the form");
  }
  fs::remove(folder_ / "data/associations.txt");
  fs::create_directory(folder_ / "data/associations.txt");
  expect_refused("associations.txt: cannot be opened");
  fs::remove(folder_ / "data/associations.txt");
  fs::remove(folder_ / "data/depth.txt");
  expect_refused("is no data set in TUM layout");
  fs::remove_all(folder_ / "data");
  expect_refused("there is no such folder");
}

TEST_F(BadInputTest, WrongArgumentsAreRefused) {
  ExpectSentence(Run("--camera no_such_camera"), "known are");
  ExpectSentence(Run("--camera no/such.yaml"), "there is no such camera file");
  ExpectSentence(Run("--set feature.nonsense=1"), "unknown option 'nonsense'");
  ExpectSentence(Run("--set feature.num_features=many"), "needs a whole number");
  ExpectSentence(Run("--config " + Path("absent.yaml")), "absent.yaml: cannot be read");
  ExpectSentence(Run("--dynamic magic"), "magic");
  EXPECT_NE(Run("--max-frames -3").exit_code, 0);
  EXPECT_NE(Run("--no-such-flag").exit_code, 0);
  folder_.Write("data/camera.yaml", "widht: 640\n");
  ExpectSentence(Run(), "camera.yaml: unknown option 'widht'");
  fs::remove(folder_ / "data/camera.yaml");
  ExpectSentence(Run(), "name the camera with --camera");
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(BadInputTest, AGroundTruthThatIsNoneOnlyCostsTheEvaluation) {
  ASSERT_EQ(Run().exit_code, 0);
  EXPECT_TRUE(fs::exists(folder_ / "out/error.svg"));
  folder_.Write("data/groundtruth.txt", "1000 0 0 0 0 0 0 1\n1001 nan 0 0 0 0 0 1\n");
  const Outcome outcome = Run();
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.output, HasSubstr("groundtruth.txt:2: 'nan' is not a finite number"));
  EXPECT_TRUE(Report().at("evaluation").is_null());
  EXPECT_FALSE(fs::exists(folder_ / "out/error.svg")) << "it shows another run";
}

TEST_F(BadInputTest, AGroundTruthThatIsACircleOfLinksOnlyCostsTheEvaluation) {
  fs::remove(folder_ / "data/groundtruth.txt");
  fs::create_symlink("groundtruth.txt", folder_ / "data/groundtruth.txt");
  const Outcome outcome = Run();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr("groundtruth.txt: cannot be opened (Too many levels"));
  EXPECT_EQ(Report().at("frames").at("with_pose"), kFrames);
}

TEST_F(BadInputTest, NamesNeedNotBeUtf8) {
  fs::rename(folder_ / "data", folder_ / "d\xff");
  fs::remove(folder_ / ("d\xff/" + Word(2, 1)));
  const Outcome outcome = RunProgram("run " + Path("d\xff") + " --out " + Path("out"));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_EQ(Report().at("name"), "d\xef\xbf\xbd") << "the sign for what is no letter";
  for (const char* name : {"trajectory.txt", "frames.csv", "map.ply", "error.svg"})
    EXPECT_TRUE(fs::exists(folder_ / "out" / name)) << name;
}

TEST_F(BadInputTest, ADataSetThatIsRenamedMeanwhileDoesNotCostTheResults) {
  WriteStamps([](int frame) { return std::to_string(1000 + frame); });
  const Outcome outcome = RunShell(
      "{ sleep 3; mv " + Path("data") + " " + Path("moved") + "; } & " MSF_PROGRAM " run " +
      Path("data") + " --realtime --out " + Path("out") + "; code=$?; wait; (exit $code)");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_FALSE(fs::exists(folder_ / "data"));
  EXPECT_EQ(Report().at("name"), "data");
  EXPECT_EQ(Report().at("frames").at("input"), kFrames);
}

TEST_F(BadInputTest, AnOverlayDoesNotTakeThePlaceOfTheResults) {
  folder_.Write("keep.txt", "");
  for (const char* overlay : {"out", "out/", "out/../out", "."}) {
    ExpectSentence(Run("--overlay " + Path(overlay)), "the results go there as well");
    EXPECT_FALSE(fs::exists(folder_ / "out"));
    EXPECT_TRUE(fs::exists(folder_ / "keep.txt"));
  }
  EXPECT_EQ(Run("--detector none --overlay " + Path("out/pictures")).exit_code, 0);
  EXPECT_TRUE(fs::exists(folder_ / "out/report.json"));
  EXPECT_TRUE(fs::exists(folder_ / "out/pictures/000007.jpg"));
}

TEST_F(BadInputTest, ASimulationThatCannotBeLeavesTheOldOne) {
  for (const char* length : {"duration_s=1e12", "duration_s=1e-3", "fps=1e9"}) {
    ExpectSentence(
        RunProgram("simulate static --set " + std::string(length) + " --out " + Path("data")),
        "duration_s and fps must give at least one frame");
  }
  folder_.Write("data/notes.txt", "precious");
  ExpectSentence(RunProgram("simulate static --frames 1 --out " + Path("data")),
                 "data/notes.txt: is no part of the data set");
  EXPECT_EQ(Run().exit_code, 0);
}

TEST_F(BadInputTest, AFullDiskLeavesWholeFilesOnly) {
  // A limit on the size of files stands for the end of the disk: map.ply is the largest.
  const Outcome outcome = RunShell("trap '' XFSZ; ulimit -f 24; " MSF_PROGRAM " run " +
                                   Path("data") + " --out " + Path("out"));
  ExpectSentence(outcome, "map.ply: cannot be written");
  EXPECT_EQ(ReadTrajectory(folder_ / "out/trajectory.txt")->size(), static_cast<size_t>(kFrames));
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_ / "out")) {
    EXPECT_NE(entry.path().filename(), "map.ply");
    EXPECT_NE(entry.path().extension(), ".part");
  }
}

TEST_F(BadInputTest, ADeterministicConfigurationDoesNotFitRealTime) {
  folder_.Write("config.yaml", "deterministic: true\n");
  ExpectSentence(Run("--realtime --config " + Path("config.yaml")),
                 "--realtime cannot be deterministic");
}

TEST_F(BadInputTest, ADataSetIsNoPlaceForResults) {
  ExpectSentence(RunProgram("run " + Path("data") + " --out " + Path("out/../data/")),
                 "that is the data set itself");
}

TEST_F(BadInputTest, AResultsFolderThatCannotBeIsFoundBeforeTheRun) {
  folder_.Write("file", "");
  const Outcome outcome = RunProgram("run " + Path("data") + " --out " + Path("file/out"));
  ExpectSentence(outcome, "file/out: the results cannot be written there");
  EXPECT_THAT(outcome.output, Not(HasSubstr("frames")));
}

TEST_F(BadInputTest, AnInterruptedRunWritesWhatItHas) {
  // Two seconds from frame to frame, so that the interrupt meets the run in its middle.
  WriteStamps([](int frame) { return std::to_string(1000 + 2 * frame); });
  for (const std::string signal : {"INT", "TERM", "HUP"}) {
    const Outcome outcome = RunAndSend(signal);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    EXPECT_THAT(outcome.output, HasSubstr("interrupted"));
    EXPECT_EQ(Report().at("interrupted"), true);
    const size_t num_poses = ReadTrajectory(folder_ / "out/trajectory.txt")->size();
    EXPECT_GE(num_poses, 1u);
    EXPECT_LT(num_poses, static_cast<size_t>(kFrames));
    fs::remove_all(folder_ / "out");
  }
}

TEST_F(BadInputTest, ARunThatWaitsForAFrameForDaysCanBeInterrupted) {
  WriteStamps([](int frame) { return std::to_string(1000 + (frame < 4 ? frame : 1e6 * frame)); });
  const Outcome outcome = RunAndSend("INT");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_EQ(Report().at("frames").at("input"), 4);
}

TEST(Detect, AnImageThatIsNoneDoesNotCostTheOthers) {
  const TestFolder folder;
  cv::imwrite((folder / "a.png").string(), cv::Mat(48, 64, CV_8UC3, cv::Scalar(99)));
  folder.Write("b.png", "no image");
  cv::imwrite((folder / "c\xff.png").string(), cv::Mat(48, 64, CV_8UC3, cv::Scalar(99)));
  const std::string path = folder.path().string();
  const Outcome outcome = RunProgram("detect " + path + " --held upright --not-mirrored --json " +
                                     path + "/found.json");
  ExpectSentence(outcome, "1 of 3 images could not be used");
  EXPECT_THAT(outcome.output, HasSubstr("b.png: is no image or a damaged one"));
  const nlohmann::json json = nlohmann::json::parse(ReadWholeFile(folder / "found.json"));
  EXPECT_TRUE(json.contains("a"));
  EXPECT_FALSE(json.contains("b"));
  EXPECT_EQ(json.size(), 2u);
}

TEST(Detect, WhatIsReadIsNotOverwritten) {
  const TestFolder folder;
  fs::create_directory(folder / "in");
  fs::create_directory_symlink("in", folder / "link");
  const std::string a = folder.Write("in/a.png", "the only copy"),
                    list = folder.Write("list.txt", "a\n");
  const std::string path = folder.path().string(), detect = "detect " + path + "/in ";
  for (const char* target : {"--overlay /in", "--overlay /link/", "--json /in/a.png"}) {
    std::string option = target;
    option.insert(option.find('/'), path);
    ExpectSentence(RunProgram(detect + option), "a.png: would be overwritten, but is read");
  }
  ExpectSentence(RunProgram(detect + "--list " + list + " --json " + list), "would be overwritten");
  EXPECT_EQ(ReadWholeFile(a), "the only copy");
}

TEST(Detect, ImagesOfOneNameAreBothNamed) {
  const TestFolder folder;
  const std::string jpg = folder.Write("x.jpg", ""), png = folder.Write("x.png", "");
  const std::string list = folder.Write("list.txt", "x\n");
  const std::string detect = "detect " + folder.path().string();
  ExpectSentence(RunProgram(detect), jpg + " and " + png + ": would have one name");
  ExpectSentence(RunProgram(detect + " --list " + list), jpg + " and " + png);
}

TEST(Detect, ListsThatAreACircleOfLinksGetASentence) {
  const TestFolder folder;
  fs::create_symlink("rgb.txt", folder / "rgb.txt");
  ExpectSentence(RunProgram("detect " + folder.path().string()), "rgb.txt: cannot be opened");
  ExpectSentence(RunProgram("detect " + (folder / "rgb.txt").string()), "no such image or folder");
}

TEST(Output, ThatCannotBeWrittenIsAFailure) {
  for (const char* arguments : {"--help", "run --help"}) {
    ExpectSentence(RunShell(MSF_PROGRAM " " + std::string(arguments) + " > /dev/full"),
                   "not all of the output could be written to stdout");
    ExpectSentence(RunShell(MSF_PROGRAM " " + std::string(arguments) + " >&-"),
                   "not all of the output could be written to stdout");
  }
}

TEST(Processor, APrecisionThatItLacksIsNamed) {
  setenv("ONEDNN_MAX_CPU_ISA", "AVX2", 1);  // in the program that runs next
  const Outcome outcome = RunProgram("detector time --precision bf16 --runs 1");
  unsetenv("ONEDNN_MAX_CPU_ISA");
  EXPECT_NE(outcome.exit_code, 0);
  EXPECT_THAT(outcome.output, HasSubstr("this processor cannot compute in bf16"));
}

}  // namespace
}  // namespace msf
