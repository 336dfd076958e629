#include "util/data_path.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

namespace msf {
namespace {

class DataPath : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_ / "models"); }
  void TearDown() override {
    unsetenv("MSF_SLAM_DATA");
    std::filesystem::remove_all(folder_);
  }
  const std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) / ("msf_data_path_" + std::to_string(getpid()));
};

TEST_F(DataPath, TheEnvironmentComesFirst) {
  std::ofstream(folder_ / "models" / "vocabulary.msfvoc") << "mine";
  setenv("MSF_SLAM_DATA", folder_.c_str(), 1);
  const StatusOr<std::filesystem::path> found = FindDataFile("models/vocabulary.msfvoc");
  ASSERT_TRUE(found.ok()) << found.message();
  EXPECT_EQ(*found, folder_ / "models" / "vocabulary.msfvoc");
}

TEST_F(DataPath, FallsThroughToTheSourceTree) {
  setenv("MSF_SLAM_DATA", folder_.c_str(), 1);
  const StatusOr<std::filesystem::path> found = FindDataFile("models/vocabulary.msfvoc");
  ASSERT_TRUE(found.ok()) << found.message();
  EXPECT_NE(*found, folder_ / "models" / "vocabulary.msfvoc");
}

TEST_F(DataPath, AMissingFileIsNamedWithThePlacesSearched) {
  setenv("MSF_SLAM_DATA", folder_.c_str(), 1);
  const StatusOr<std::filesystem::path> found = FindDataFile("models/no_such_file");
  ASSERT_FALSE(found.ok());
  EXPECT_NE(found.message().find("models/no_such_file"), std::string::npos);
  EXPECT_NE(found.message().find(folder_.string()), std::string::npos);
}

}  // namespace
}  // namespace msf
