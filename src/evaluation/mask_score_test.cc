#include "evaluation/mask_score.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "io/png_encoder.h"
#include "io/test_folder.h"

namespace msf {
namespace {

using testing::HasSubstr;

// The left half of 80 x 60 moves.
cv::Mat LeftHalf() {
  cv::Mat mask = cv::Mat::zeros(60, 80, CV_8UC1);
  mask(cv::Rect(0, 0, 40, 60)).setTo(1);
  return mask;
}

LabelledFrame FrameWith(std::vector<LabelledPoint> points) {
  LabelledFrame frame;
  frame.time_s = 5;
  frame.points = std::move(points);
  return frame;
}

// On the mover: one removed of each kind, one settled, one kept. Elsewhere: one removed, two kept,
// one readmitted. One at the border.
LabelledFrame SmallFrame() {
  return FrameWith({{0, 0, 0.05f, PointReason::kObject},
                    {10, 59, 0.1f, PointReason::kFlow},
                    {20, 30, 0.1f, PointReason::kDepth},
                    {35, 30, 0.05f, PointReason::kBox},
                    {10, 10, 0.35f, PointReason::kSettled},
                    {12, 10, 1, PointReason::kStatic},
                    {60, 30, 0.1f, PointReason::kFlow},
                    {70, 30, 1, PointReason::kStatic},
                    {79, 59, 1, PointReason::kStatic},
                    {50, 30, 0.3f, PointReason::kReadmitted},
                    {42, 30, 1, PointReason::kStatic}});
}

TEST(MaskScore, CountsPointsOnBothSides) {
  MaskScore score;
  AddToScore(SmallFrame(), LeftHalf(), {}, score);
  EXPECT_EQ(score.on_movers.Total(), 6);
  EXPECT_EQ(score.on_movers.Removed(), 4);
  EXPECT_EQ(score.on_static.Total(), 4);
  EXPECT_EQ(score.near_border, 1);
  EXPECT_DOUBLE_EQ(score.Recall(), 4.0 / 6);
  EXPECT_DOUBLE_EQ(score.Precision(), 4.0 / 5);
  EXPECT_DOUBLE_EQ(score.on_static.KeptShare(), 3.0 / 4);
  EXPECT_DOUBLE_EQ(score.on_static.Share(PointReason::kReadmitted), 1.0 / 4);
  EXPECT_DOUBLE_EQ(score.on_movers.Share(PointReason::kSettled), 1.0 / 6);
}

TEST(MaskScore, TheBorderIsFourPixelsWideOnEitherSide) {
  for (const auto& [x, near] :
       {std::pair(34, false), {35, false}, {36, true}, {43, true}, {44, false}}) {
    MaskScore score;
    AddToScore(FrameWith({{static_cast<float>(x), 30, 1, PointReason::kStatic}}), LeftHalf(), {},
               score);
    EXPECT_EQ(score.near_border, near) << x;
  }
}

TEST(MaskScore, NothingMovesAndNothingIsRemoved) {
  MaskScore score;
  AddToScore(FrameWith({{5, 5, 1, PointReason::kStatic}}), cv::Mat::zeros(60, 80, CV_8UC1), {},
             score);
  EXPECT_EQ(score.Recall(), 0);
  EXPECT_EQ(score.Precision(), 0);
  EXPECT_EQ(score.on_static.KeptShare(), 1);
}

TEST(MaskScore, ActorsAreFoundByOverlap) {
  LabelledFrame frame = SmallFrame();
  frame.objects = {{0, "person", "known", "moving", true, true, 0.5f, {0, 0, 38, 60}}};
  const std::vector<TrueActor> actors = {{"person", {0, 0, 40, 60}, 2400},
                                         {"person", {60, 0, 62, 10}, 20}};
  MaskScore score;
  AddToScore(frame, LeftHalf(), actors, score);
  ASSERT_EQ(score.actors.size(), 2u);
  EXPECT_EQ(score.actors[0].size_class, 0);
  EXPECT_EQ(score.actors[0].followed, 0);
  EXPECT_EQ(score.actors[1].size_class, 4);
  EXPECT_EQ(score.actors[1].followed, 1);
  EXPECT_EQ(score.actors[1].detected, 0);
}

class MaskFolder : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_ / "mask");
    folder_.Write("mask/5.000000.png", EncodePng(LeftHalf()));
    LabelledFrame frame = SmallFrame();
    frame.objects = {{3, "person", "known", "moving", true, false, 0.5f, {0, 0, 40, 60}}};
    LabelledFrame without_mask = SmallFrame();
    without_mask.frame = 1;
    without_mask.time_s = 6;
    ASSERT_TRUE(WriteLabels(folder_ / "labels.csv", {frame, without_mask}).ok());
    ASSERT_TRUE(WriteObjects(folder_ / "objects.csv", {frame, without_mask}).ok());
  }
  StatusOr<MaskScore> Score(const std::string& masks) {
    return ScoreAgainstMasks("run", folder_ / "labels.csv", folder_ / masks);
  }

  TestFolder folder_;
};

TEST_F(MaskFolder, ReadsWhatWasWritten) {
  folder_.Write("actors.txt", "# header\n5.000000 1 person 2400 0 0 39 59\n");
  for (const char* masks : {"mask", "."}) {
    const StatusOr<MaskScore> score = Score(masks);
    ASSERT_TRUE(score.ok()) << score.message();
    EXPECT_EQ(score->num_frames, 1u);
    EXPECT_EQ(score->num_frames_without_mask, 1u);
    EXPECT_EQ(score->on_movers.Removed(), 4);
    ASSERT_EQ(score->actors.size(), 1u);
    EXPECT_EQ(score->actors[0].detected, 1);
    EXPECT_THAT(
        FormatMaskScore(*score),
        AllOf(HasSubstr("recall 66.7 %"), HasSubstr("person, over 30 %"), HasSubstr("100.0 %")));
    EXPECT_EQ(MaskScoreToJson(*score).at("dynamic").at("points"), 6);
  }
}

TEST_F(MaskFolder, ReadsActorsOfBothForms) {
  folder_.Write("actors.txt",
                "5.000000 -1 none -1 -1 -1 -1 -1 0 0 0 0 0 0\n"
                "5.000000 0 clip 7 0 0 39 59 2400 2400 0.5 1.5 0.2 0.5\n");
  const StatusOr<MaskScore> score = Score("mask");
  ASSERT_TRUE(score.ok()) << score.message();
  ASSERT_EQ(score->actors.size(), 1u);
  EXPECT_EQ(score->actors[0].class_name, "person");
  EXPECT_EQ(score->actors[0].detected, 1);
}

TEST_F(MaskFolder, MasksOfAnotherSizeAreNamed) {
  folder_.Write("mask/5.000000.png", EncodePng(cv::Mat::zeros(30, 40, CV_8UC1)));
  EXPECT_THAT(Score("mask").message(),
              AllOf(HasSubstr("labels.csv"), HasSubstr("5.000000.png of 40x30 pixels")));
}

TEST_F(MaskFolder, ActorsOfTwoFormsInOneFileAreNamed) {
  folder_.Write("actors.txt",
                "5.000000 1 person 2400 0 0 39 59\n5.000000 2 dining table 2400 0 0 39 59\n");
  EXPECT_THAT(Score("mask").message(), HasSubstr("actors.txt:2: has 9 columns"));
  folder_.Write("actors.txt", "5.000000 2 dining table 2400 0 0 39 59\n");
  EXPECT_THAT(Score("mask").message(), HasSubstr("actors.txt:1: 'table' is no number"));
  folder_.Write("actors.txt", "5.000000 1 person 2400 0 0 39\n");
  EXPECT_THAT(Score("mask").message(), HasSubstr("actors.txt:1: has fewer than 8 columns"));
}

TEST_F(MaskFolder, MistakesAreNamed) {
  EXPECT_THAT(Score("nowhere").message(), HasSubstr("no such folder"));
  std::filesystem::rename(folder_ / "mask/5.000000.png", folder_ / "mask/9.000000.png");
  EXPECT_THAT(Score("mask").message(), HasSubstr("no time stamp in common"));
  folder_.Write("labels.csv", "frame,time_s,x,y,reason,static_probability\n0,5,1,1,magic,1\n");
  EXPECT_THAT(Score("mask").message(), HasSubstr("labels.csv:2"));
  folder_.Write("labels.csv", "a,b\n");
  EXPECT_THAT(Score("mask").message(), HasSubstr("columns"));
}

}  // namespace
}  // namespace msf
