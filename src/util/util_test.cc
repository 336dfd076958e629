#include <gmock/gmock.h>
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

using testing::AllOf;
using testing::HasSubstr;

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

TEST(Options, NumbersAreFinite) {
  OuterOptions options;
  for (const char* number : {".nan", ".inf", "-.inf", "1e999", "nan", ""}) {
    const Status status = SetOption(std::string("inner.radius_px=") + number, options);
    EXPECT_THAT(status.message(), HasSubstr("'inner.radius_px' needs a finite number")) << number;
  }
  EXPECT_EQ(options.inner.radius_px, 2.5);
}

TEST(Options, NumbersAreWrittenAsShortAsTheyAreRead) {
  InnerOptions options;
  for (const double number : {0.7, 0.1 + 0.2, 5000.0, 1e-9, -1.0 / 3}) {
    options.radius_px = number;
    InnerOptions read;
    ASSERT_TRUE(ReadOptions(YAML::Load(YAML::Dump(OptionsToYaml(options))), read).ok());
    EXPECT_EQ(read.radius_px, number);
  }
  options.radius_px = 0.7;
  EXPECT_EQ(YAML::Dump(OptionsToYaml(options)), "radius_px: 0.7");
  EXPECT_THAT(DescribeOptions(options), HasSubstr(" 0.7 "));
}

TEST(Options, FilesThatAreNoOptionsAreNamed) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "options.yaml";
  const auto message = [&](const std::string& text) {
    std::ofstream(file) << text;
    OuterOptions options;
    return LoadOptions(file, options).message();
  };
  EXPECT_EQ(message("count: 5\n"), "");
  EXPECT_EQ(message("---\ncount: 5\n...\n"), "");
  EXPECT_EQ(message(""), "");
  EXPECT_THAT(message("count: 5\n[1, 2]: 3\n"),
              AllOf(HasSubstr("options.yaml: "), HasSubstr("line 2 is no word")));
  EXPECT_THAT(message("count: 5\n? {a: b}\n"), HasSubstr("is no word"));
  EXPECT_THAT(message("inner:\n  radius_px: 1\n  radius_px: 2\n"),
              AllOf(HasSubstr("options.yaml: option 'radius_px' in section 'inner'"),
                    HasSubstr("given again in line 3")));
  EXPECT_THAT(message("inner: {radius_px: 1}\ncount: 5\ninner: {radius_px: 2}\n"),
              HasSubstr("'inner' at the top level is given again in line 3"));
  EXPECT_THAT(message("count: 5\n---\ncount: 6\n"),
              AllOf(HasSubstr("options.yaml: "), HasSubstr("2 documents")));
  OuterOptions options;
  EXPECT_THAT(LoadOptions(testing::TempDir(), options).message(), HasSubstr("is a folder"));
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
