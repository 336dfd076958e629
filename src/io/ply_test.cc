#include "io/ply.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "io/test_folder.h"

namespace msf {
namespace {

TEST(Ply, HoldsHeaderAndPackedVertices) {
  const TestFolder folder;
  ASSERT_TRUE(
      WritePly(folder / "map.ply", {{{1, 2, 3}, {10, 20, 30}}, {{-1, 0.5f, 0}, {255, 0, 1}}}).ok());
  const std::string content = ReadWholeFile(folder / "map.ply");
  EXPECT_THAT(content, testing::StartsWith("ply\nformat binary_little_endian 1.0\n"));
  EXPECT_THAT(content, testing::HasSubstr("element vertex 2\n"));
  const std::string end = "end_header\n";
  const size_t body = content.find(end) + end.size();
  ASSERT_EQ(content.size() - body, 2u * 15);
  float y = 0;
  std::memcpy(&y, content.data() + body + 15 + 4, 4);
  EXPECT_EQ(y, 0.5f);
  EXPECT_EQ(static_cast<uint8_t>(content[body + 15 + 12]), 255);
}

TEST(Ply, NoPointsAreAValidCloud) {
  const TestFolder folder;
  ASSERT_TRUE(WritePly(folder / "map.ply", {}).ok());
  EXPECT_THAT(ReadWholeFile(folder / "map.ply"),
              testing::EndsWith("element vertex 0\nproperty float x\nproperty float y\n"
                                "property float z\nproperty uchar red\nproperty uchar green\n"
                                "property uchar blue\nend_header\n"));
}

}  // namespace
}  // namespace msf
