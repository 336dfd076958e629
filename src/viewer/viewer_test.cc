#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "io/test_folder.h"
#include "viewer/overlay_recorder.h"

namespace msf {
namespace {

using testing::HasSubstr;

// A grey picture with one static and one removed point, and a masked object.
DynamicsView SmallView() {
  DynamicsView view;
  view.color = cv::Mat(240, 321, CV_8UC1, cv::Scalar(100));
  view.points_px = {{20, 30}, {200, 100}};
  view.result.labels = PointLabels(2);
  view.result.labels.Set(1, PointReason::kFlow, 0.1f);
  view.result.mask = cv::Mat1b(60, 80, static_cast<uint8_t>(0));
  view.result.mask(cv::Rect(40, 20, 20, 20)).setTo(255);
  view.result.objects.resize(1);
  view.result.objects[0].name = "person";
  view.result.objects[0].removed = true;
  view.result.objects[0].box = {160, 80, 240, 160};
  return view;
}

TEST(DynamicsDrawing, ShowsMaskPointsAndLegendInEvenSize) {
  const DynamicsView view = SmallView();
  const cv::Mat picture = DrawDynamics(view);
  EXPECT_EQ(picture.type(), CV_8UC3);
  EXPECT_EQ(picture.cols, 322);
  EXPECT_EQ(picture.rows % 2, 0);
  EXPECT_GT(picture.rows, 240);
  EXPECT_EQ(picture.at<cv::Vec3b>(5, 5), cv::Vec3b(100, 100, 100)) << "nothing there";
  const cv::Vec3b masked = picture.at<cv::Vec3b>(120, 230), still = picture.at<cv::Vec3b>(30, 20),
                  moving = picture.at<cv::Vec3b>(100, 200);
  EXPECT_GT(masked[2], masked[1]);
  EXPECT_GT(still[1], still[2]);
  EXPECT_GT(moving[2], moving[1]);
  EXPECT_GT(cv::countNonZero(picture.rowRange(240, picture.rows).reshape(1) > 150), 100)
      << "the legend";
  EXPECT_EQ(view.color.at<uint8_t>(30, 20), 100) << "the frame itself is left alone";
}

TEST(DynamicsDrawing, BoxesOutsideTheImageAndMissingMasksDoNoHarm) {
  DynamicsView view = SmallView();
  view.result.mask.release();
  view.result.objects[0].box = {-500, -500, 9000, 9000};
  view.points_px[0] = {-40, 900};
  EXPECT_EQ(DrawDynamics(view).cols, 322);
}

cv::Mat Picture(int grey) { return {64, 96, CV_8UC3, cv::Scalar::all(grey)}; }

TEST(PictureWriter, AVideoAppearsWhenItIsComplete) {
  const TestFolder folder;
  const std::filesystem::path file = folder / "a/b.mp4";
  {
    StatusOr<std::unique_ptr<PictureWriter>> writer = PictureWriter::Create(file, 30);
    ASSERT_TRUE(writer.ok()) << writer.message();
    for (int i = 0; i < 12; ++i) ASSERT_TRUE((*writer)->Add(Picture(10 * i)).ok());
    EXPECT_FALSE(std::filesystem::exists(file));
    const Status finished = (*writer)->Finish();
    ASSERT_TRUE(finished.ok()) << finished.message();
  }
  cv::VideoCapture video(file.string());
  cv::Mat picture;
  int count = 0;
  for (; video.read(picture); ++count) EXPECT_EQ(picture.size(), cv::Size(96, 64));
  EXPECT_EQ(count, 12);
}

TEST(PictureWriter, AnUnfinishedRecordingLeavesNothing) {
  const TestFolder folder;
  for (const char* name : {"b.mp4", "pictures"}) {
    {
      StatusOr<std::unique_ptr<PictureWriter>> writer = PictureWriter::Create(folder / name, 30);
      ASSERT_TRUE((*writer)->Add(Picture(1)).ok());
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << name;
  }
}

TEST(PictureWriter, AFolderOfPicturesReplacesAnOlderOne) {
  const TestFolder folder;
  for (const int count : {3, 2}) {
    StatusOr<std::unique_ptr<PictureWriter>> writer =
        PictureWriter::Create(folder / "pictures/", 30);
    ASSERT_TRUE(writer.ok()) << writer.message();
    for (int i = 0; i < count; ++i) ASSERT_TRUE((*writer)->Add(Picture(i)).ok());
    ASSERT_TRUE((*writer)->Finish().ok());
    EXPECT_TRUE(std::filesystem::exists(folder / "pictures/000001.jpg"));
    EXPECT_EQ(std::filesystem::exists(folder / "pictures/000002.jpg"), count == 3);
  }
}

TEST(PictureWriter, AVideoThatTheDiskCutShortIsAnError) {
  const TestFolder folder;
  StatusOr<std::unique_ptr<PictureWriter>> writer = PictureWriter::Create(folder / "b.mp4", 30);
  cv::Mat picture = Picture(0);
  cv::RNG random(1);
  for (int i = 0; i < 60; ++i) {
    random.fill(picture, cv::RNG::UNIFORM, 0, 255);  // needs many bytes
    ASSERT_TRUE((*writer)->Add(picture).ok());
  }
  // A limit on the size of files stands for the end of the disk.
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit little = {1 << 15, before.rlim_max};
  const auto signal_before = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &little), 0);
  const Status finished = (*writer)->Finish();
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, signal_before);
  EXPECT_THAT(finished.message(), HasSubstr("b.mp4: the pictures cannot be written there"));
  writer->reset();
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(PictureWriter, AUsersPicturesAreNotThrownAway) {
  const TestFolder folder;
  std::filesystem::create_directories(folder / "photos");
  folder.Write("photos/20240817.jpg", "of the holiday");
  EXPECT_THAT(PictureWriter::Create(folder / "photos", 30).message(), HasSubstr("other files"));

  std::filesystem::create_directories(folder / "empty");
  StatusOr<std::unique_ptr<PictureWriter>> writer = PictureWriter::Create(folder / "empty", 30);
  ASSERT_TRUE(writer.ok()) << writer.message();
  ASSERT_TRUE((*writer)->Add(Picture(1)).ok());
  folder.Write("empty/1.jpg", "put there meanwhile");
  EXPECT_THAT((*writer)->Finish().message(), HasSubstr("other files"));
  EXPECT_TRUE(std::filesystem::exists(folder / "empty/1.jpg"));
}

TEST(PictureWriter, UnfinishedNamesOfOthersAreLeftAlone) {
  const TestFolder folder;
  const std::string own = "." + std::to_string(getpid()) + ".part";
  for (const std::string& part : {std::string(".part"), own}) {
    for (const std::string& name : {"b.mp4" + part, "pictures" + part}) {
      std::filesystem::create_directories(folder / name);
      folder.Write(name + "/thesis.tex", "x");
    }
  }
  folder.Write("b.part.mp4", "x");
  for (const char* name : {"b.mp4", "pictures"})
    EXPECT_THAT(PictureWriter::Create(folder / name, 30).message(), HasSubstr(own));
  for (const char* name : {"c.mp4", "others"}) {
    StatusOr<std::unique_ptr<PictureWriter>> writer = PictureWriter::Create(folder / name, 30);
    ASSERT_TRUE(writer.ok()) << writer.message();
    ASSERT_TRUE((*writer)->Add(Picture(1)).ok());
    EXPECT_TRUE((*writer)->Finish().ok());
  }
  for (const std::string& part : {std::string(".part"), own}) {
    for (const std::string& name : {"b.mp4" + part, "pictures" + part})
      EXPECT_TRUE(std::filesystem::exists(folder / (name + "/thesis.tex"))) << name;
  }
  EXPECT_EQ(ReadWholeFile(folder / "b.part.mp4"), "x");
}

TEST(PictureWriter, ALinkStaysAndWhatItPointsToIsReplaced) {
  const TestFolder folder;
  std::filesystem::create_directories(folder / "real");
  std::filesystem::create_directory_symlink("real", folder / "link");
  std::filesystem::create_symlink("real.mp4", folder / "link.mp4");
  for (const char* name : {"link", "link.mp4"}) {
    StatusOr<std::unique_ptr<PictureWriter>> writer = PictureWriter::Create(folder / name, 30);
    ASSERT_TRUE(writer.ok()) << writer.message();
    ASSERT_TRUE((*writer)->Add(Picture(1)).ok());
    ASSERT_TRUE((*writer)->Finish().ok());
    EXPECT_TRUE(std::filesystem::is_symlink(folder / name)) << name;
  }
  EXPECT_TRUE(std::filesystem::exists(folder / "real/000000.jpg"));
  EXPECT_TRUE(std::filesystem::is_regular_file(folder / "real.mp4"));
}

TEST(PictureWriter, OtherFilesAreNotThrownAway) {
  const TestFolder folder;
  std::filesystem::create_directories(folder / "pictures");
  folder.Write("pictures/thesis.tex", "x");
  EXPECT_THAT(PictureWriter::Create(folder / "pictures", 30).message(), HasSubstr("other files"));
  EXPECT_THAT(PictureWriter::Create(folder / "pictures/thesis.tex", 30).message(),
              HasSubstr(".mp4"));
  EXPECT_FALSE(PictureWriter::Create(folder / "pictures/thesis.tex/a.mp4", 30).ok());
  EXPECT_FALSE(PictureWriter::Create("/proc/a.mp4", 30).ok());
  EXPECT_FALSE(PictureWriter::Create("/proc/pictures", 30).ok());
}

TEST(OverlayRecorder, DrawsEveryFrameOnce) {
  const TestFolder folder;
  StatusOr<std::shared_ptr<OverlayRecorder>> recorder =
      OverlayRecorder::Create(folder / "pictures", 30, false);
  ASSERT_TRUE(recorder.ok()) << recorder.message();
  const DynamicsView view = SmallView();
  RgbdFrame frame;
  frame.color = view.color;
  FrameFeatures features;
  features.image_px = view.points_px;
  for (int i = 0; i < 20; ++i) {
    frame.id = FrameId(i);
    (*recorder)->OnDynamics(frame, features, view.result);
    (*recorder)->OnFrame({});
  }
  (*recorder)->OnFrame({});  // one of which nothing is known
  const Status finished = (*recorder)->Finish();
  ASSERT_TRUE(finished.ok()) << finished.message();
  EXPECT_EQ((*recorder)->num_left_out(), 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "pictures/000019.jpg"));
  EXPECT_FALSE(std::filesystem::exists(folder / "pictures/000020.jpg"));
}

}  // namespace
}  // namespace msf
