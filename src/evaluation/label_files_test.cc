#include "evaluation/label_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/test_folder.h"

namespace msf {
namespace {

using testing::HasSubstr;

constexpr const char* kLabelsHeader = "frame,time_s,x,y,reason,static_probability\n";
constexpr const char* kObjectsHeader =
    "frame,time_s,id,class,kind,state,removed,bridged,score,x0,y0,x1,y1\n";

LabelledFrame FrameWithObjects(const std::vector<std::string>& names) {
  LabelledFrame frame;
  frame.frame = 7;
  frame.time_s = 1000.5;
  frame.points = {{12.25f, 479.5f, 0.125f, PointReason::kFlow}};
  for (const std::string& name : names)
    frame.objects.push_back({3, name, "known", "moving", true, false, 0.5f, {-2, 0, 40, 60}});
  return frame;
}

TEST(LabelFiles, ClassNamesMayHoldWhatSeparatesCells) {
  const TestFolder folder;
  const std::vector<std::string> names = {"person", "cup, red", "the \"thing\"", "\"", ",", ""};
  const std::vector<LabelledFrame> frames = {FrameWithObjects(names)};
  ASSERT_TRUE(WriteLabels(folder / "labels.csv", frames).ok());
  ASSERT_TRUE(WriteObjects(folder / "objects.csv", frames).ok());
  EXPECT_THAT(ReadWholeFile(folder / "objects.csv"),
              AllOf(HasSubstr(",person,known"), HasSubstr(",\"cup, red\",known"),
                    HasSubstr(",\"the \"\"thing\"\"\",known")));
  const StatusOr<std::vector<LabelledFrame>> read = ReadLabels(folder / "labels.csv");
  ASSERT_TRUE(read.ok()) << read.message();
  ASSERT_EQ(read->size(), 1u);
  EXPECT_EQ(read->front().points.at(0).y_px, 479.5f);
  ASSERT_EQ(read->front().objects.size(), names.size());
  for (size_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(read->front().objects[i].name, names[i]);
    EXPECT_EQ(read->front().objects[i].box.y1, 60);
  }
}

TEST(LabelFiles, ANameStaysOnItsLine) {
  const TestFolder folder;
  const std::vector<LabelledFrame> frames = {FrameWithObjects({"two\nlines"})};
  ASSERT_TRUE(WriteLabels(folder / "labels.csv", frames).ok());
  ASSERT_TRUE(WriteObjects(folder / "objects.csv", frames).ok());
  EXPECT_EQ(ReadLabels(folder / "labels.csv")->front().objects.at(0).name, "two lines");
}

TEST(LabelFiles, NumbersThatNoFrameHasAreNamed) {
  const TestFolder folder;
  const auto message = [&](const std::string& row) {
    return ReadLabels(folder.Write("labels.csv", kLabelsHeader + row + "\n")).message();
  };
  EXPECT_EQ(message("0,5,1,1,static,1"), "");
  EXPECT_EQ(message("0,5,-0.00,-0.50,static,1"), "");
  for (const char* row :
       {"0,5,1e30,1,static,1", "0,5,1,-1e30,static,1", "0,5,20000,1,static,1", "0,5,1,1,static,7",
        "1e300,5,1,1,static,1", "-1,5,1,1,static,1", "0,1e300,1,1,static,1", "0,5,nan,1,static,1",
        "0,5,1,1,static", "0,5,1,1,static,1,1", "0,5,1,1,\"static,1"})
    EXPECT_THAT(message(row), HasSubstr("labels.csv:2: '" + std::string(row) + "' makes no sense"));
}

TEST(LabelFiles, ObjectsThatNoFrameHasAreNamed) {
  const TestFolder folder;
  folder.Write("labels.csv", std::string(kLabelsHeader) + "0,5,1,1,static,1\n");
  const auto message = [&](const std::string& row) {
    folder.Write("objects.csv", kObjectsHeader + row + "\n");
    return ReadLabels(folder / "labels.csv").message();
  };
  EXPECT_EQ(message("0,5,3,person,known,moving,1,0,0.5,-700,0,9000,60"), "");
  for (const char* row : {"1e300,5,3,person,known,moving,1,0,0.5,0,0,40,60",
                          "0,5,1e12,person,known,moving,1,0,0.5,0,0,40,60",
                          "0,5,3,person,known,moving,1,0,0.5,0,0,1e30,60",
                          "0,5,3,person,known,moving,1,0,50,0,0,40,60"})
    EXPECT_THAT(message(row), HasSubstr("objects.csv:2: ")) << row;
  std::filesystem::remove(folder / "objects.csv");
  std::filesystem::create_symlink("objects.csv", folder / "objects.csv");
  EXPECT_THAT(ReadLabels(folder / "labels.csv").message(),
              HasSubstr("objects.csv: cannot be read"));
}

}  // namespace
}  // namespace msf
