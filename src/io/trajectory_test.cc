#include "io/trajectory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/test_folder.h"

namespace msf {
namespace {

using testing::HasSubstr;

// The error of a file with this content.
std::string ErrorOf(const std::string& content) {
  const TestFolder folder;
  return ReadTrajectory(folder.Write("t.txt", content)).message();
}

TEST(Trajectory, ReadsPosesCommentsAndScaledQuaternions) {
  const TestFolder folder;
  const auto file = folder.Write("t.txt",
                                 "# time x y z qx qy qz qw\r\n\n1305031102.175304 1 -2.5 +3e-1 0 0 "
                                 "0 1\r\n1305031103 0 0 0 0 0 2 2 # turned\n");
  const StatusOr<Trajectory> t = ReadTrajectory(file);
  ASSERT_TRUE(t.ok()) << t.message();
  ASSERT_EQ(t->size(), 2u);
  EXPECT_DOUBLE_EQ((*t)[0].time_s, 1305031102.175304);
  EXPECT_EQ((*t)[0].T_wc.translation(), Eigen::Vector3d(1, -2.5, 0.3));
  EXPECT_NEAR((*t)[1].T_wc.Angle(), M_PI / 2, 1e-12);
}

TEST(Trajectory, ErrorsNameFileLineAndReason) {
  EXPECT_THAT(ErrorOf("1 0 0 0 0 0 0 1\n2 0 nan 0 0 0 0 1\n"),
              AllOf(HasSubstr("t.txt:2:"), HasSubstr("'nan'")));
  EXPECT_THAT(ErrorOf("1 0 0 0 0 0 0 inf\n"), HasSubstr("'inf'"));
  EXPECT_THAT(ErrorOf("1 0 0 0 0 0 1\n"), AllOf(HasSubstr("t.txt:1:"), HasSubstr("has 7")));
  EXPECT_THAT(ErrorOf("1 0 0 0x 0 0 0 1\n"), HasSubstr("'0x'"));
  EXPECT_THAT(ErrorOf("1 0 0 0 0 0 0 0\n"), HasSubstr("quaternion"));
  EXPECT_THAT(ErrorOf("# first\n2 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n"),
              AllOf(HasSubstr("t.txt:3:"), HasSubstr("sort")));
  EXPECT_THAT(ErrorOf("# nothing\n"), HasSubstr("no pose"));
  EXPECT_THAT(ReadTrajectory("/nowhere/t.txt").message(), HasSubstr("cannot be opened"));
}

TEST(Trajectory, WritesTheTumFormAndReadsItBack) {
  const TestFolder folder;
  const Rigid3d pose(ExpRotation({0.1, -0.2, 0.3}), Eigen::Vector3d(1.23456789012, -2, 3));
  const Trajectory written = {{1305031102.175304, Rigid3d()}, {1305031102.211214, pose}};
  ASSERT_TRUE(WriteTrajectory(folder / "t.txt", written).ok());
  EXPECT_THAT(ReadWholeFile(folder / "t.txt"),
              testing::StartsWith(
                  "1305031102.175304 0.000000000 0.000000000 0.000000000 0.000000000 0.000000000 "
                  "0.000000000 1.000000000\n1305031102.211214 1.234567890 -2.000000000 "));
  const StatusOr<Trajectory> read = ReadTrajectory(folder / "t.txt");
  ASSERT_TRUE(read.ok());
  EXPECT_NEAR(((*read)[1].T_wc.Inverse() * pose).Log().norm(), 0, 1e-8);
}

TEST(Trajectory, WritingToAMissingFolderIsAnError) {
  EXPECT_THAT(WriteTrajectory("/nowhere/t.txt", {}).message(), HasSubstr("/nowhere/t.txt"));
}

}  // namespace
}  // namespace msf
