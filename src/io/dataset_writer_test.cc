#include "io/dataset_writer.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "io/test_folder.h"
#include "io/tum_dataset.h"

namespace msf {
namespace {

namespace fs = std::filesystem;

RgbdFrame MakeFrame(double time_s) {
  RgbdFrame frame;
  frame.time_s = time_s;
  Camera camera = *Camera::Preset("simulated");
  camera.width = 64;
  camera.height = 48;
  camera.cx = 31.5;
  camera.cy = 23.5;
  frame.camera = std::make_shared<const Camera>(camera);
  frame.color = cv::Mat(48, 64, CV_8UC3);
  cv::randu(frame.color, 0, 255);
  frame.depth = cv::Mat(48, 64, CV_16UC1);
  cv::randu(frame.depth, 0, 30000);
  return frame;
}

TEST(DatasetWriter, WhatIsWrittenIsReadBack) {
  const TestFolder folder;
  const fs::path target = folder.path() / "sequence";
  std::vector<RgbdFrame> frames;
  {
    DatasetWriter writer = *DatasetWriter::Create(target, "marker.yaml");
    for (int i = 0; i < 3; ++i) {
      frames.push_back(MakeFrame(1000 + 0.033333 * i));
      ASSERT_TRUE(writer.AddFrame(frames.back(), cv::Mat(48, 64, CV_8UC1, cv::Scalar(i))).ok());
    }
    EXPECT_FALSE(fs::exists(target));  // not before it is complete
    ASSERT_TRUE(writer.Finish({{999.99, Rigid3d()}, {1000.1, Rigid3d()}}).ok());
  }
  TumDataset dataset = *TumDataset::Open(target);
  EXPECT_TRUE(dataset.warnings().empty());
  ASSERT_EQ(dataset.size(), 3u);
  EXPECT_EQ(dataset.camera().width, 64);
  EXPECT_EQ(dataset.camera().fx, 525);
  for (int i = 0; i < 3; ++i) {
    const RgbdFramePtr read = *dataset.Load(i);
    EXPECT_EQ(cv::norm(read->color, frames[i].color, cv::NORM_INF), 0);
    EXPECT_EQ(cv::norm(read->depth, frames[i].depth, cv::NORM_INF), 0);
    EXPECT_NEAR(read->time_s, frames[i].time_s, 1e-6);
  }
  EXPECT_EQ(cv::imread(target / "mask" / "1000.066666.png", cv::IMREAD_UNCHANGED).at<uint8_t>(3, 3),
            2);
  EXPECT_EQ(ReadTrajectory(target / "groundtruth.txt")->size(), 2u);
  for (const char* name : {"rgb.txt", "depth.txt", "associations.txt", "mask.txt", "marker.yaml"}) {
    EXPECT_TRUE(fs::exists(target / name)) << name;
  }
  EXPECT_FALSE(fs::exists(target.string() + ".part"));
}

TEST(DatasetWriter, ReplacesItsOwnFoldersOnly) {
  const TestFolder folder;
  const fs::path foreign = folder.path() / "photos", own = folder.path() / "own";
  fs::create_directory(foreign);
  std::ofstream(foreign / "holiday.txt") << "precious";
  const StatusOr<DatasetWriter> refused = DatasetWriter::Create(foreign, "marker.yaml");
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.message().find("photos"), std::string::npos);
  EXPECT_TRUE(fs::exists(foreign / "holiday.txt"));

  for (int round = 0; round < 2; ++round) {
    DatasetWriter writer = *DatasetWriter::Create(own, "marker.yaml");
    ASSERT_TRUE(writer.AddFrame(MakeFrame(round)).ok());
    ASSERT_TRUE(writer.Finish({{0, Rigid3d()}}).ok());
  }
  EXPECT_FALSE(fs::exists(own / "rgb" / "0.000000.png"));
  EXPECT_TRUE(fs::exists(own / "rgb" / "1.000000.png"));
}

TEST(DatasetWriter, WhatIsNoPartOfADatasetIsNotRemoved) {
  const TestFolder folder;
  const fs::path target = folder.path() / "own";
  const auto write = [&] {
    StatusOr<DatasetWriter> writer = DatasetWriter::Create(target, "marker.yaml");
    if (!writer.ok()) return writer.status();
    MSF_RETURN_IF_ERROR(writer->AddFrame(MakeFrame(1), cv::Mat(48, 64, CV_8UC1, cv::Scalar(1))));
    MSF_RETURN_IF_ERROR(writer->AddFile("actors.txt", ""));
    return writer->Finish({{0, Rigid3d()}});
  };
  ASSERT_TRUE(write().ok());
  for (const char* mine : {"notes.txt", "rgb/notes.txt", "rgb/more/1.png", "results/report.json"}) {
    const fs::path file = target / mine;
    fs::create_directories(file.parent_path());
    std::ofstream(file) << "precious";
    EXPECT_NE(write().message().find("is no part of the data set"), std::string::npos) << mine;
    EXPECT_TRUE(fs::exists(file));
    fs::remove(file);
    if (fs::is_empty(file.parent_path())) fs::remove(file.parent_path());
    EXPECT_TRUE(write().ok()) << mine;
  }
}

TEST(DatasetWriter, WithoutFramesTheOldDatasetStays) {
  const TestFolder folder;
  const fs::path target = folder.path() / "own";
  for (const bool has_frame : {true, false}) {
    DatasetWriter writer = *DatasetWriter::Create(target, "marker.yaml");
    EXPECT_TRUE(!has_frame || writer.AddFrame(MakeFrame(1)).ok());
    EXPECT_EQ(writer.Finish({{0, Rigid3d()}}).ok(), has_frame);
  }
  EXPECT_EQ(TumDataset::Open(target)->size(), 1u);
}

TEST(DatasetWriter, ALinkToTheFolderStays) {
  const TestFolder folder;
  fs::create_directory(folder / "real");
  fs::create_directory_symlink("real", folder / "link");
  DatasetWriter writer = *DatasetWriter::Create(folder / "link", "marker.yaml");
  ASSERT_TRUE(writer.AddFrame(MakeFrame(1)).ok());
  ASSERT_TRUE(writer.Finish({{0, Rigid3d()}}).ok());
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_TRUE(fs::exists(folder / "real/rgb.txt"));
}

TEST(DatasetWriter, UnfinishedWorkLeavesNothing) {
  const TestFolder folder;
  const fs::path target = folder.path() / "sequence";
  {
    DatasetWriter writer = *DatasetWriter::Create(target, "marker.yaml");
    ASSERT_TRUE(writer.AddFrame(MakeFrame(1)).ok());
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(DatasetWriter, ErrorsNameTheFile) {
  const TestFolder folder;
  std::ofstream(folder.path() / "file") << "x";
  const StatusOr<DatasetWriter> writer =
      DatasetWriter::Create(folder.path() / "file" / "sequence", "marker.yaml");
  ASSERT_FALSE(writer.ok());
  EXPECT_NE(writer.message().find("sequence"), std::string::npos);
}

}  // namespace
}  // namespace msf
