#include "io/tum_dataset.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "io/test_folder.h"

namespace msf {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kTinyCamera = "width: 8\nheight: 6\nfx: 10\nfy: 10\ncx: 3.5\ncy: 2.5\n";

// A sequence of three tiny frames.
void WriteSequence(const TestFolder& folder) {
  folder.Write("camera.yaml", kTinyCamera);
  folder.Write("rgb.txt", "# colour\n1.00 a.png\n1.03 b.png\n1.06 c.png\n");
  folder.Write("depth.txt", "1.001 da.png\n1.032 db.png\n1.055 dc.png\n");
  for (const char* name : {"a.png", "b.png", "c.png"}) {
    cv::imwrite((folder / name).string(), cv::Mat(6, 8, CV_8UC3, cv::Scalar(10, 20, 30)));
    cv::imwrite((folder / (std::string("d") + name)).string(),
                cv::Mat(6, 8, CV_16UC1, cv::Scalar(5000)));
  }
}

// The sentence of loading frame 1 after `damage`; the other two frames must still be fine.
template <typename Damage>
std::string ErrorOfFrame1(Damage damage) {
  const TestFolder folder;
  WriteSequence(folder);
  damage(folder);
  StatusOr<TumDataset> dataset = TumDataset::Open(folder.path());
  EXPECT_TRUE(dataset.ok()) << dataset.message();
  EXPECT_TRUE(dataset->Load(0).ok());
  EXPECT_TRUE(dataset->Load(2).ok());
  return dataset->Load(1).message();
}

TEST(TumDataset, LoadsFrames) {
  const TestFolder folder;
  WriteSequence(folder);
  StatusOr<TumDataset> dataset = TumDataset::Open(folder.path());
  ASSERT_TRUE(dataset.ok()) << dataset.message();
  ASSERT_EQ(dataset->size(), 3u);
  EXPECT_THAT(dataset->warnings(), IsEmpty());
  EXPECT_FALSE(dataset->ground_truth_file());
  const StatusOr<RgbdFramePtr> frame = dataset->Load(1);
  ASSERT_TRUE(frame.ok()) << frame.message();
  EXPECT_EQ((*frame)->id, FrameId(1));
  EXPECT_DOUBLE_EQ((*frame)->time_s, 1.03);
  EXPECT_EQ((*frame)->color.at<cv::Vec3b>(2, 3), cv::Vec3b(10, 20, 30));
  EXPECT_EQ((*frame)->depth.at<uint16_t>(2, 3), 5000);
  EXPECT_TRUE(CheckFrame(**frame).ok());
}

TEST(TumDataset, PrefersAssociationsAndReadsJpegAndTransparentColour) {
  const TestFolder folder;
  WriteSequence(folder);
  cv::imwrite((folder / "a.jpg").string(), cv::Mat(6, 8, CV_8UC3, cv::Scalar(10, 20, 30)));
  cv::imwrite((folder / "b.png").string(), cv::Mat(6, 8, CV_8UC4, cv::Scalar(1, 2, 3, 4)));
  folder.Write("associations.txt", "1.00 a.jpg 1.5 da.png\n1.03 b.png 1.5 db.png\n");
  folder.Write("groundtruth.txt", "");
  StatusOr<TumDataset> dataset = TumDataset::Open(folder.path());
  ASSERT_TRUE(dataset.ok()) << dataset.message();
  ASSERT_EQ(dataset->size(), 2u);
  EXPECT_TRUE(dataset->ground_truth_file());
  EXPECT_EQ((*dataset->Load(0))->color.type(), CV_8UC3);
  EXPECT_EQ((*dataset->Load(1))->color.at<cv::Vec3b>(0, 0), cv::Vec3b(1, 2, 3));
}

TEST(TumDataset, BrokenImagesConcernTheirFrameOnly) {
  EXPECT_THAT(ErrorOfFrame1([](const TestFolder& f) { std::filesystem::remove(f / "b.png"); }),
              AllOf(HasSubstr("b.png"), HasSubstr("No such file")));
  EXPECT_THAT(
      ErrorOfFrame1([](const TestFolder& f) { std::filesystem::resize_file(f / "db.png", 60); }),
      AllOf(HasSubstr("db.png"), HasSubstr("damaged")));
  EXPECT_THAT(ErrorOfFrame1([](const TestFolder& f) { f.Write("b.png", ""); }), HasSubstr("empty"));
  EXPECT_THAT(ErrorOfFrame1([](const TestFolder& f) { f.Write("b.png", "no image at all"); }),
              HasSubstr("damaged"));
  EXPECT_THAT(ErrorOfFrame1([](const TestFolder& f) {
                cv::imwrite((f / "b.png").string(), cv::Mat::zeros(4, 8, CV_8UC3));
              }),
              AllOf(HasSubstr("8x4"), HasSubstr("8x6")));
  EXPECT_THAT(ErrorOfFrame1([](const TestFolder& f) {
                cv::imwrite((f / "db.png").string(), cv::Mat::zeros(6, 8, CV_8UC1));
              }),
              AllOf(HasSubstr("16-bit"), HasSubstr("this one is 8-bit, 1 channel")));
  EXPECT_THAT(ErrorOfFrame1([](const TestFolder& f) {
                cv::imwrite((f / "b.png").string(), cv::Mat::zeros(6, 8, CV_16UC1));
              }),
              AllOf(HasSubstr("8 bits"), HasSubstr("16-bit, 1 channel")));
  EXPECT_THAT(ErrorOfFrame1([](const TestFolder& f) {
                std::filesystem::remove(f / "b.png");
                std::filesystem::create_directory(f / "b.png");
              }),
              HasSubstr("cannot be opened"));
}

TEST(TumDataset, SurvivesAndTellsFlawsOfTheLists) {
  const TestFolder folder;
  WriteSequence(folder);
  folder.Write(
      "rgb.txt",
      "1.06 c.png\nrubbish\n1.00 a.png\n1.03 b.png\nnan x.png\n1.03 b.png\n9 lonely.png\n");
  const StatusOr<TumDataset> dataset = TumDataset::Open(folder.path());
  ASSERT_TRUE(dataset.ok()) << dataset.message();
  ASSERT_EQ(dataset->size(), 3u);
  EXPECT_DOUBLE_EQ(dataset->time_s(0), 1.00);
  EXPECT_THAT(
      dataset->warnings(),
      ElementsAre(
          HasSubstr("2 lines not of the form 'timestamp path' left out, the first is line 2"),
          HasSubstr("out of order"), HasSubstr("1 line with a repeated"),
          HasSubstr("1 of 4 colour images have no depth")));
}

TEST(TumDataset, ColourAndDepthOfOtherTimesAreNoFrame) {
  const TestFolder folder;
  WriteSequence(folder);
  folder.Write("associations.txt", "1.00 a.png 1.00 da.png\n1.03 b.png 2.04 db.png\n");
  const StatusOr<TumDataset> dataset = TumDataset::Open(folder.path());
  ASSERT_TRUE(dataset.ok()) << dataset.message();
  EXPECT_EQ(dataset->size(), 1u);
  EXPECT_THAT(dataset->warnings(),
              ElementsAre(HasSubstr("1 line not of the form 't_rgb rgb t_depth depth, stamps at "
                                    "most 1 s apart' left out, the first is line 2")));
}

TEST(TumDataset, AByteOrderMarkIsNoPartOfTheFirstLine) {
  const TestFolder folder;
  WriteSequence(folder);
  folder.Write("rgb.txt",
               "\xef\xbb\xbf"
               "1.00 a.png\n1.03 b.png\n1.06 c.png\n");
  EXPECT_EQ(TumDataset::Open(folder.path())->size(), 3u);
  folder.Write("associations.txt", "\xef\xbb\xbf# made by hand\n1.00 a.png 1.00 da.png\n");
  const StatusOr<TumDataset> dataset = TumDataset::Open(folder.path());
  ASSERT_TRUE(dataset.ok()) << dataset.message();
  EXPECT_THAT(dataset->warnings(), IsEmpty());
}

TEST(TumDataset, LinksInACircleGetASentence) {
  namespace fs = std::filesystem;
  const TestFolder folder;
  WriteSequence(folder);
  const auto put_circle = [&](const std::string& name) {
    fs::remove(folder / name);
    fs::create_symlink(name, folder / name);
  };
  put_circle("b.png");
  put_circle("groundtruth.txt");
  StatusOr<TumDataset> dataset = TumDataset::Open(folder.path());
  ASSERT_TRUE(dataset.ok()) << dataset.message();
  EXPECT_THAT(dataset->Load(1).message(), AllOf(HasSubstr("b.png"), HasSubstr("Too many levels")));
  EXPECT_TRUE(dataset->ground_truth_file()) << "reading it tells what is wrong";
  for (const char* name : {"rgb.txt", "associations.txt"}) {
    put_circle(name);
    EXPECT_THAT(TumDataset::Open(folder.path()).message(),
                AllOf(HasSubstr(name), HasSubstr("Too many levels")));
  }
  put_circle("circle");
  EXPECT_THAT(TumDataset::Open(folder / "circle").message(), HasSubstr("no such folder"));
}

TEST(TumDataset, WhatIsNoDatasetGetsASentence) {
  const TestFolder folder;
  EXPECT_THAT(TumDataset::Open(folder / "absent").message(), HasSubstr("no such folder"));
  EXPECT_THAT(TumDataset::Open(folder.path()).message(), HasSubstr("rgb.txt and depth.txt"));
  WriteSequence(folder);
  folder.Write("depth.txt", "# empty\n");
  EXPECT_THAT(TumDataset::Open(folder.path()).message(), HasSubstr("depth.txt: has no line"));
  folder.Write("depth.txt", "50 da.png\n");
  EXPECT_THAT(TumDataset::Open(folder.path()).message(),
              HasSubstr("no colour image has a depth image"));
}

TEST(TumDataset, TheCameraIsNeverGuessed) {
  const TestFolder folder;
  WriteSequence(folder);
  EXPECT_DOUBLE_EQ(TumDataset::Open(folder.path(), "tum_fr2")->camera().depth_factor, 5208);
  EXPECT_THAT(TumDataset::Open(folder.path(), "tum_fr9").message(), HasSubstr("tum_fr1"));
  EXPECT_THAT(TumDataset::Open(folder.path(), (folder / "absent.yaml").string()).message(),
              HasSubstr("no such camera file"));
  folder.Write("camera.yaml", "fx: 10\nfy: 10\nfocus: 3\n");
  EXPECT_THAT(TumDataset::Open(folder.path()).message(),
              AllOf(HasSubstr("camera.yaml"), HasSubstr("focus")));
  folder.Write("camera.yaml", "fx: 10\n");
  EXPECT_THAT(TumDataset::Open(folder.path()).message(),
              AllOf(HasSubstr("camera.yaml"), HasSubstr("fy")));
  std::filesystem::remove(folder / "camera.yaml");
  EXPECT_THAT(TumDataset::Open(folder.path()).message(),
              AllOf(HasSubstr("--camera"), HasSubstr("bonn")));
}

TEST(AssociateByTime, NearestPairsFirstEachImageOnce) {
  const auto list = [](std::initializer_list<double> times) {
    std::vector<ListedImage> images;
    for (const double t : times) images.push_back({t, std::to_string(t)});
    return images;
  };
  // 1.010 is nearer to 1.012 than 1.000 is, so 1.000 must take 0.985; 2.00 and 2.02 are just too
  // far apart.
  const std::vector<FrameFiles> frames =
      AssociateByTime(list({1.000, 1.012, 2.00}), list({0.985, 1.010, 2.0201}));
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_DOUBLE_EQ(frames[0].depth_time_s, 0.985);
  EXPECT_DOUBLE_EQ(frames[1].depth_time_s, 1.010);
}

}  // namespace
}  // namespace msf
