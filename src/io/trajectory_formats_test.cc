#include "io/trajectory_formats.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/test_folder.h"

namespace msf {
namespace {

using testing::HasSubstr;

const std::vector<double> kTimes_s = {1.5, 2.5};

TEST(ForeignTrajectory, TellsTheFormsApart) {
  const TestFolder folder;
  // A quarter turn about z, at (1, 2, 3).
  const std::string tum = "1.5 1 2 3 0 0 0.70710678 0.70710678\n2.5 1 2 3 0 0 0 1\n";
  const std::string kitti = "0 -1 0 1 1 0 0 2 0 0 1 3\n1 0 0 1 0 1 0 2 0 0 1 3\n";
  const std::string euroc =
      "#timestamp [ns],p_x,p_y,p_z,q_w,q_x,q_y,q_z,v_x\n"
      "1500000000000000000, 1, 2, 3, 0.70710678, 0, 0, 0.70710678, 0\n"
      "1500000001000000000,1,2,3,1,0,0,0,0\n";
  const std::string orb_slam =
      "1500000000000000000.0 1 2 3 0 0 0.70710678 0.70710678\n"
      "1500000001000000000.0 1 2 3 0 0 0 1\n";
  for (const std::string& text : {tum, kitti, euroc, orb_slam}) {
    const StatusOr<Trajectory> read = ReadForeignTrajectory(folder.Write("t.txt", text), kTimes_s);
    ASSERT_TRUE(read.ok()) << read.message();
    ASSERT_EQ(read->size(), 2u);
    EXPECT_NEAR((*read)[1].time_s - (*read)[0].time_s, 1, 1e-6);
    EXPECT_NEAR(((*read)[0].T_wc * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(1, 3, 3)).norm(), 0,
                1e-7)
        << text;
  }
  EXPECT_NEAR((*ReadForeignTrajectory(folder.Write("e.csv", euroc), {}))[0].time_s, 1.5e9, 1e-3);
  EXPECT_EQ((*ReadForeignTrajectory(folder.Write("k.txt", kitti), kTimes_s))[1].time_s, 2.5);
}

TEST(ForeignTrajectory, MistakesAreSentences) {
  const TestFolder folder;
  const auto message = [&](const std::string& text) {
    return ReadForeignTrajectory(folder.Write("t.txt", text), kTimes_s).message();
  };
  EXPECT_THAT(message("1 0 0 1 0 1 0 2 0 0 1 3\n"), HasSubstr("1 poses in KITTI's form"));
  EXPECT_THAT(message("1 2 3\n"), HasSubstr("t.txt:1: is no pose"));
  EXPECT_THAT(message("1 2 x 4 5 6 7 8\n"), HasSubstr("'x' is not a finite number"));
  EXPECT_THAT(message("1 0 0 0 0 0 0 0\n"), HasSubstr("quaternion is zero"));
  EXPECT_THAT(message("2 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n"), HasSubstr("t.txt:2: the time stamp"));
  EXPECT_THAT(message("# nothing\n"), HasSubstr("holds no pose"));
  EXPECT_FALSE(ReadForeignTrajectory(folder / "absent.txt", kTimes_s).ok());
}

}  // namespace
}  // namespace msf
