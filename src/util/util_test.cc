#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "util/atomic_file.h"
#include "util/bounded_queue.h"
#include "util/markup.h"
#include "util/options.h"

namespace msf {
namespace {

struct InnerOptions {
  double radius_px = 2.5;
  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("radius_px", radius_px, "search radius, px");
  }
};

struct OuterOptions {
  int count = 3;
  InnerOptions inner;
  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("count", count, "how many");
    visit("inner", inner, "");
  }
};

TEST(Options, SetReachesNestedFields) {
  OuterOptions options;
  EXPECT_TRUE(SetOption("inner.radius_px=7", options).ok());
  EXPECT_TRUE(SetOption("count=5", options).ok());
  EXPECT_EQ(options.inner.radius_px, 7);
  EXPECT_EQ(options.count, 5);
}

TEST(Options, UnknownKeyAndWrongTypeAreNamed) {
  OuterOptions options;
  EXPECT_NE(SetOption("inner.radius=7", options)
                .message()
                .find("unknown option 'radius' in section 'inner'"),
            std::string::npos);
  EXPECT_NE(SetOption("count=many", options).message().find("'count' needs a whole number"),
            std::string::npos);
  EXPECT_FALSE(SetOption("inner=3", options).ok());
  EXPECT_FALSE(SetOption("no assignment", options).ok());
}

TEST(Options, YamlRoundTrip) {
  OuterOptions options;
  options.count = 9;
  OuterOptions read;
  EXPECT_TRUE(ReadOptions(OptionsToYaml(options), read).ok());
  EXPECT_EQ(read.count, 9);
  EXPECT_NE(DescribeOptions<OuterOptions>().find("inner.radius_px"), std::string::npos);
}

struct ListOptions {
  std::vector<InnerOptions> parts;
  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("parts", parts, "several of them");
  }
};

TEST(Options, ListsOfSectionsAreReadWrittenAndChecked) {
  InnerOptions inner;
  const YAML::Node one = OptionsToYaml(inner);
  YAML::Node node;
  node["parts"].push_back(YAML::Clone(one));
  node["parts"].push_back(YAML::Clone(one));
  ListOptions options;
  ASSERT_TRUE(ReadOptions(node, options).ok());
  EXPECT_EQ(options.parts.size(), 2u);
  EXPECT_EQ(OptionsToYaml(options)["parts"].size(), 2u);
  EXPECT_NE(DescribeOptions(options).find("parts[]."), std::string::npos);

  node["parts"][1]["colour"] = 3;
  const Status status = ReadOptions(node, options);
  ASSERT_FALSE(status.ok());
  EXPECT_NE(status.message().find("parts[1]"), std::string::npos);
  EXPECT_FALSE(ReadOptions(YAML::Load("{parts: 7}"), options).ok());
}

TEST(AtomicFile, FailedWriteLeavesTheOldFile) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "atomic_file";
  std::filesystem::create_directories(folder);
  const std::filesystem::path file = folder / "a.txt";
  ASSERT_TRUE(WriteFileAtomically(file, "old").ok());
  const Status status =
      WriteFileAtomically(file, [](std::ostream& stream) { stream.setstate(std::ios::badbit); });
  EXPECT_FALSE(status.ok());
  EXPECT_NE(status.message().find("a.txt"), std::string::npos);
  std::string content;
  std::ifstream(file) >> content;
  EXPECT_EQ(content, "old");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
}

TEST(BoundedQueue, HandsOutEverythingAfterClose) {
  BoundedQueue<int> queue(2);
  std::thread producer([&] {
    for (int i = 0; i < 100; ++i) queue.Push(i);
    queue.Close();
  });
  int expected = 0;
  while (const std::optional<int> item = queue.Pop()) EXPECT_EQ(*item, expected++);
  producer.join();
  EXPECT_EQ(expected, 100);
  EXPECT_FALSE(queue.Push(1));
}

TEST(EscapeMarkup, NothingIsReadAsMarkup) {
  EXPECT_EQ(EscapeMarkup("a < b && \"c\" > d"), "a &lt; b &amp;&amp; &quot;c&quot; &gt; d");
  EXPECT_EQ(EscapeMarkup(""), "");
}

}  // namespace
}  // namespace msf
