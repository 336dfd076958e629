#include "bench/suite.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "bench/test_suite.h"
#include "io/test_folder.h"

namespace msf {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr char kSmall[] =
    "sequences: [{name: s, scenario: xyz}]\nvariants: [{name: \"off\", dynamic: \"off\"}]\n";

TEST(Suite, ThoseThatShipMakeSense) {
  const std::vector<std::string> names = SuiteNames();
  for (const char* name : {"tum_dynamic", "tum_static", "bonn_dynamic", "composited", "simulated",
                           "threshold", "ablation", "core_ablation", "runtime", "detector"}) {
    EXPECT_THAT(names, Contains(name));
    const StatusOr<Suite> suite = LoadSuite(name);
    ASSERT_TRUE(suite.ok()) << suite.message();
    EXPECT_EQ(suite->name, name);
    EXPECT_FALSE(suite->description.empty());
    for (const SuiteSequence& sequence : suite->sequences) {
      if (!sequence.folder.starts_with("rgbd_")) continue;
      EXPECT_THAT(sequence.address, HasSubstr("https://"));
    }
  }
  EXPECT_EQ(LoadSuite("tum_dynamic")->sequences.size(), 8u);
}

TEST(Suite, ReadsAFileAndNamesItselfAfterIt) {
  const TestFolder folder;
  folder.Write("o.yaml", "dynamic: {mode: boxes}\n");
  const std::string file = folder.Write("mine.yaml", std::string(kSmall) + "repeats: 3\n");
  const StatusOr<Suite> suite = LoadSuite(file);
  ASSERT_TRUE(suite.ok()) << suite.message();
  EXPECT_EQ(suite->name, "mine");
  EXPECT_EQ(suite->repeats, 3);
  EXPECT_EQ(suite->variants[0].dynamic, "off");
  const StatusOr<Suite> with_config = LoadSuite(folder.Write(
      "config.yaml",
      "sequences: [{name: s, scenario: xyz}]\nvariants: [{name: v, config: o.yaml}]\n"));
  ASSERT_TRUE(with_config.ok());
  EXPECT_EQ(with_config->variants[0].config, (folder / "o.yaml").string());
}

TEST(Suite, MistakesAreSentences) {
  const TestFolder folder;
  const auto message = [&](const std::string& text) {
    return LoadSuite(folder.Write("s.yaml", text)).message();
  };
  EXPECT_THAT(message("repeat: 3\n"), HasSubstr("unknown option 'repeat'"));
  EXPECT_THAT(message("sequences: [{name: s, scene: xyz}]\n"), HasSubstr("'scene' in section"));
  EXPECT_THAT(message("sequences: [\n"), HasSubstr("not valid YAML"));
  EXPECT_THAT(message("{}"), HasSubstr("needs sequences and variants"));
  EXPECT_THAT(message(std::string(kSmall) + "mode: fast\n"), HasSubstr("'fast' is no mode"));
  EXPECT_THAT(message(std::string(kSmall) + "repeats: 0\n"), HasSubstr("repeats"));
  for (const char* limit : {"0", "-5", ".nan", ".inf"}) {
    EXPECT_THAT(message(kSmall + fmt::format("time_limit_s: {}\n", limit)),
                HasSubstr("time_limit_s"))
        << limit;
  }
  EXPECT_THAT(message("sequences: [{name: a/b, scenario: xyz}]\nvariants: [{name: v}]\n"),
              HasSubstr("'a/b' is no name"));
  EXPECT_THAT(message("sequences: [{name: s}]\nvariants: [{name: v}]\n"),
              HasSubstr("either a folder"));
  EXPECT_THAT(message("sequences: [{name: s, scenario: xyz}]\nvariants: [{name: v}, {name: v}]\n"),
              HasSubstr("two variants 'v'"));
  EXPECT_THAT(
      message("sequences: [{name: s, scenario: x}]\nvariants: [{name: v, sequences: [t]}]\n"),
      HasSubstr("'t' is not in the suite"));
  EXPECT_THAT(message(std::string(kSmall) + "ours: best\n"), HasSubstr("'best', which is no"));
  EXPECT_THAT(LoadSuite("no_such_suite").message(),
              testing::AllOf(HasSubstr("no suite 'no_such_suite'"), HasSubstr("tum_dynamic")));
  EXPECT_THAT(LoadSuite("no/such.yaml").message(), HasSubstr("there is no such file"));
}

TEST(Suite, ALimitIsANumber) {
  Suite suite = TestSuite();
  suite.time_limit_s = std::nan("");
  EXPECT_THAT(suite.Check().message(), HasSubstr("time_limit_s must be positive"));
  suite = TestSuite();
  suite.variants[0].time_limit_s = std::nan("");
  EXPECT_THAT(suite.Check().message(), HasSubstr("variant 'off'"));
}

TEST(Suite, KeepsWhatIsWanted) {
  Suite suite = TestSuite();
  ASSERT_TRUE(suite.KeepOnly({}, {"full"}).ok());
  EXPECT_EQ(suite.variants.size(), 1u);
  EXPECT_EQ(suite.sequences.size(), 3u);
  ASSERT_TRUE(suite.KeepOnly({"calm", "walking"}, {}).ok());
  EXPECT_EQ(suite.sequences.size(), 2u);
  EXPECT_THAT(suite.KeepOnly({}, {"off"}).message(), HasSubstr("no variant 'off', only: full"));
}

}  // namespace
}  // namespace msf
