#include "bench/plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "bench/test_suite.h"
#include "io/test_folder.h"

namespace msf {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

TEST(Plan, HasEveryRunThoseInRealTimeLast) {
  const Plan plan = MakePlan(TestSuite(), {{}, "seq", "build", 0});
  ASSERT_EQ(plan.tasks.size(), 10u);
  EXPECT_EQ(plan.tasks.front().id, "walking/off/0");
  EXPECT_EQ(plan.tasks[7].id, "calm/full/1");
  EXPECT_EQ(plan.tasks.back().id, "walking/live/1");
  EXPECT_TRUE(plan.tasks.back().alone);
  EXPECT_THAT(plan.tasks.front().arguments,
              ElementsAre("--deterministic", "--dynamic", "off", "--seed", "0"));
  EXPECT_THAT(plan.tasks[1].arguments, testing::Contains("1")) << "the next repeat's seed";
  EXPECT_FALSE(plan.tasks.front().score_masks);
  EXPECT_TRUE(plan.Find("walking/full/0")->score_masks);
}

TEST(Plan, NamesWhatIsMissing) {
  const Plan plan = MakePlan(TestSuite(), {{}, "seq", "build", 0});
  ASSERT_EQ(plan.missing.size(), 1u);
  EXPECT_THAT(DescribeMissing(plan.missing[0]),
              testing::AllOf(HasSubstr("recorded"), HasSubstr("'not_here'"),
                             HasSubstr("https://example.org/not_here.tgz")));
  EXPECT_THAT(DescribeMissing({"s", "s", "not public", ""}), testing::EndsWith("; not public"));
  EXPECT_THAT(DescribeMissing({"s", "s", "", ""}), HasSubstr("no address"));
  const TestFolder root;
  std::filesystem::create_directories(root / "not_here");
  EXPECT_TRUE(MakePlan(TestSuite(), {{root.path()}, "seq", "build", 0}).missing.empty());
}

TEST(Plan, RendersTheSameSequenceIntoTheSameFolder) {
  Suite suite = TestSuite();
  suite.sequences.push_back(suite.sequences[0]);
  suite.sequences.back().name = "again";
  const Plan plan = MakePlan(suite, {{}, "seq", "build", 0});
  EXPECT_EQ(plan.FolderOf("again"), plan.FolderOf("walking"));
  EXPECT_NE(plan.FolderOf("calm"), plan.FolderOf("walking"));
  EXPECT_THAT(plan.renderings[1].arguments, testing::Contains("--without-actors"));
}

TEST(Plan, FingerprintsTellWhatDecidesTheResult) {
  const auto fingerprint = [](const Suite& suite, const std::string& build = "build") {
    return MakePlan(suite, {{}, "seq", build, 0}).tasks[0].fingerprint;
  };
  Suite suite = TestSuite();
  const std::string before = fingerprint(suite);
  EXPECT_NE(fingerprint(suite, "another build"), before);
  suite.variants[0].set = {"feature.num_features=500"};
  EXPECT_NE(fingerprint(suite), before);
  suite = TestSuite();
  suite.sequences[0].frames = 13;
  EXPECT_NE(fingerprint(suite), before);
  // Another folder for the same sequences is not another result.
  EXPECT_EQ(MakePlan(TestSuite(), {{}, "elsewhere", "build", 0}).tasks[0].fingerprint, before);
}

TEST(Plan, ThresholdsBecomeOptions) {
  Suite suite = TestSuite();
  suite.variants[0].dynamic = "paper";
  suite.variants[0].threshold_px = 0.5;
  suite.variants[1].threshold_px = 2;
  const Plan plan = MakePlan(suite, {{}, "seq", "build", 0});
  EXPECT_THAT(plan.Find("walking/off/0")->arguments,
              testing::Contains("dynamic.paper_flow_px=0.5"));
  EXPECT_THAT(plan.Find("walking/full/0")->arguments,
              testing::Contains("dynamic.motion.min_residual_px=2"));
}

TEST(Plan, DetectorsAreTasks) {
  Suite suite;
  suite.detectors = {{"d", "d.onnx"}};
  suite.detector_data.folder = "VOC";
  EXPECT_EQ(MakePlan(suite, {{}, "seq", "build", 0}).missing.size(), 1u);
  const TestFolder root;
  std::filesystem::create_directories(root / "VOC");
  const Plan plan = MakePlan(suite, {{root.path()}, "seq", "build", 0});
  ASSERT_EQ(plan.tasks.size(), 1u);
  EXPECT_TRUE(plan.tasks[0].is_detector);
  EXPECT_THAT(plan.tasks[0].arguments, ElementsAre("--model", "d.onnx", "--size", "320x320"));
}

TEST(Plan, SurvivesItsFile) {
  const TestFolder folder;
  const Plan plan = MakePlan(TestSuite(), {{}, "seq", "build", 7});
  const StatusOr<Plan> read = ReadPlan(folder.Write("plan.json", PlanToJson(plan).dump()));
  ASSERT_TRUE(read.ok()) << read.message();
  ASSERT_EQ(read->tasks.size(), plan.tasks.size());
  EXPECT_EQ(PlanToJson(*read), PlanToJson(plan));
  EXPECT_EQ(read->tasks[0].time_limit_s, 7);
  EXPECT_THAT(ReadPlan(folder.Write("bad.json", "{\"tasks\": [{}]}")).message(),
              HasSubstr("is no plan"));
  EXPECT_FALSE(ReadPlan(folder / "absent.json").ok());
}

TEST(Plan, DropsWhatTurnsOutNotToBeThere) {
  Plan plan = MakePlan(TestSuite(), {{}, "seq", "build", 0});
  plan.Drop("walking", "could not be rendered: no");
  EXPECT_EQ(plan.tasks.size(), 4u);
  EXPECT_EQ(plan.FolderOf("walking"), "");
  EXPECT_EQ(DescribeMissing(plan.missing.back()), "walking: could not be rendered: no");
  EXPECT_THAT(DescribeMissing(plan.missing.back()), Not(HasSubstr("root")));
}

}  // namespace
}  // namespace msf
