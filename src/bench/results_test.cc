#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "bench/bench_run.h"
#include "bench/comparison.h"
#include "bench/peers.h"
#include "bench/run_record.h"
#include "bench/slurm.h"
#include "bench/task_run.h"
#include "bench/test_suite.h"
#include "io/test_folder.h"

namespace msf {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr char kReport[] = R"({
  "frames": {"input": 10, "with_pose": 9, "by_state": {"tracking": 9, "lost": 1}}, "coverage": 0.9,
  "dynamic": {"point_share": {"static": 0.75},
              "detector": {"mean_ms": 30, "frames_detected": 5, "age_frames": {"p50": 1, "p95": 2}}},
  "evaluation": {"ate_m": {"rmse": 1, "std": 2, "mean": 3, "median": 4, "max": 5, "min": 0},
                 "rpe_1_frame": {"translation_m": null, "rotation_deg": null},
                 "rpe_1_s": {"translation_m": null, "rotation_deg": null}},
  "wall_time_s": 2, "cpu_time_s": 3, "peak_memory_mb": 100,
  "timing_ms": {"total": {"p50": 7, "p95": 8, "p99": 9}}})";

TEST(TaskResult, TakesTheFiguresOfARun) {
  const TestFolder folder;
  TaskResult result;
  ASSERT_TRUE(AddRunReport(folder.Write("report.json", kReport), result).ok());
  EXPECT_EQ(result.num_frames, 10u);
  EXPECT_EQ(*result.coverage, 0.9);
  EXPECT_EQ(result.ate_m->median, 4);
  EXPECT_FALSE(result.rpe_frame_m.has_value());
  EXPECT_EQ(*result.static_share, 0.75);
  EXPECT_EQ(result.timing.p99_ms, 9);
  EXPECT_EQ(result.timing.age_p95_frames, 2);
  EXPECT_THAT(AddRunReport(folder.Write("bad.json", "{}"), result).message(),
              HasSubstr("is no report"));
  EXPECT_THAT(AddRunReport(folder / "absent.json", result).message(), HasSubstr("left no report"));
  EXPECT_THAT(AddRunReport(folder.path(), result).message(), HasSubstr("left no report"));
}

TEST(TaskResult, SurvivesItsFile) {
  const TestFolder folder;
  TaskResult result = TestResults().results[1];
  result.reason = "why \"not\"";
  result.timing.energy_j = 3.5;
  result.detector = DetectorFigures{0.1, 0.2, 0.3, 0.4, 5, 6};
  ASSERT_TRUE(WriteTaskResult(folder / "r.json", result).ok());
  const std::optional<TaskResult> read = ReadTaskResult(folder / "r.json");
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(ResultToJson(*read), ResultToJson(result));
  EXPECT_EQ(TimingToJson(read->timing), TimingToJson(result.timing));
  EXPECT_FALSE(ReadTaskResult(folder / "absent.json").has_value());
  EXPECT_FALSE(ReadTaskResult(folder.path()).has_value());
  EXPECT_FALSE(ReadTaskResult(folder.Write("cut.json", "{\"id\": ")).has_value());
}

TEST(Resume, OnlyWhatHasNoFittingResultIsOpen) {
  const TestFolder folder;
  const BenchResults results = TestResults();
  ASSERT_TRUE(PrepareBenchFolder(folder / "out", false).ok());
  EXPECT_THAT(PrepareBenchFolder(folder / "out", false).message(), HasSubstr("--resume"));
  ASSERT_TRUE(PrepareBenchFolder(folder / "out", true).ok());
  const auto write = [&](size_t i, const std::string& status, const std::string& fingerprint) {
    TaskResult result = results.results[i];
    result.status = status;
    if (!fingerprint.empty()) result.fingerprint = fingerprint;
    std::filesystem::create_directories(TaskFolder(folder / "out", results.plan.tasks[i]));
    ASSERT_TRUE(
        WriteTaskResult(TaskResultFile(folder / "out", results.plan.tasks[i]), result).ok());
  };
  write(0, "ok", "");
  write(1, "crashed", "");
  write(2, "ok", "of another build");
  EXPECT_EQ(OpenTasks(folder / "out", results.plan, false).size(), 8u);
  EXPECT_EQ(OpenTasks(folder / "out", results.plan, true).size(), 9u);
  ForgetResults(folder / "out", {results.plan.tasks[0]});
  EXPECT_EQ(OpenTasks(folder / "out", results.plan, false).size(), 9u);
  write(0, "ok", "");
  const std::vector<TaskResult> collected = CollectResults(folder / "out", results.plan);
  ASSERT_EQ(collected.size(), 10u);
  EXPECT_EQ(collected[1].status, "crashed");
  EXPECT_EQ(collected[2].status, "lost");
  EXPECT_THAT(PrepareBenchFolder("/proc/no", false).message(), HasSubstr("cannot be written"));
}

class ComparisonTest : public ::testing::Test {
 protected:
  // Writes a bench's results below `name` and returns the file.
  std::filesystem::path Write(const std::string& name, const BenchResults& results) const {
    std::filesystem::create_directories(folder_ / name);
    EXPECT_TRUE(WriteResults(folder_ / name, results).ok());
    return folder_ / (name + "/results.json");
  }
  const TestFolder folder_;
  const std::filesystem::path before_ = Write("before", TestResults());
};

TEST_F(ComparisonTest, TheSameIsNoRegression) {
  const StatusOr<Comparison> same = CompareResults(before_, before_, {});
  ASSERT_TRUE(same.ok()) << same.message();
  EXPECT_EQ(same->NumRegressions(), 0u);
  EXPECT_GT(same->rows.size(), 10u);
}

TEST_F(ComparisonTest, FindsWhatBecameWorse) {
  BenchResults worse = TestResults();
  for (TaskResult& result : worse.results) {
    if (result.variant == "full") result.ate_m->rmse *= 1.5;
    if (result.variant == "live") result.coverage = 0.4;
    result.timing.p50_ms *= 2;
  }
  worse.results.erase(worse.results.begin());
  worse.results.front().status = "crashed";  // walking/off/1
  const auto after = Write("worse", worse);
  const StatusOr<Comparison> comparison = CompareResults(before_, after, {});
  ASSERT_TRUE(comparison.ok());
  EXPECT_EQ(comparison->NumRegressions(), 5u) << FormatComparison(*comparison);
  EXPECT_THAT(FormatComparison(*comparison), HasSubstr("WORSE"));
  EXPECT_EQ(CompareResults(before_, after, {.tolerance = 0.6})->NumRegressions(), 3u);
  EXPECT_GT(
      CompareResults(before_, after, {.tolerance = 0.6, .time_tolerance = 0.5})->NumRegressions(),
      4u);
}

TEST_F(ComparisonTest, WhatIsGoneIsARegression) {
  BenchResults less = TestResults();
  std::erase_if(less.results, [](const TaskResult& r) { return r.sequence == "calm"; });
  EXPECT_EQ(CompareResults(before_, Write("less", less), {})->NumRegressions(), 2u);
  EXPECT_EQ(CompareResults(folder_ / "less/results.json", before_, {})->NumRegressions(), 0u);
  EXPECT_THAT(CompareResults(before_, folder_.path(), {}).message(),
              AllOf(HasSubstr(folder_.path().string()), HasSubstr("is a folder")));
  EXPECT_THAT(CompareResults(before_, folder_ / "absent.json", {}).message(),
              HasSubstr("no such file"));
  EXPECT_THAT(CompareResults(before_, folder_.Write("x.json", "{}"), {}).message(),
              HasSubstr("no results of a bench"));
}

TEST(Slurm, ScriptKnowsEveryTask) {
  std::vector<Task> tasks = TestResults().plan.tasks;
  tasks[0].time_limit_s = 90;
  tasks.resize(3);
  const std::string script = SlurmScript("out", tasks, {"", 2});
  EXPECT_THAT(script, AllOf(HasSubstr("#SBATCH --array=0-2%2\n"), HasSubstr("'walking/off/0'"),
                            HasSubstr("'walking/full/0'"), HasSubstr("--cpus-per-task=1"),
                            Not(HasSubstr("--exclusive"))));
  tasks[0].alone = true;
  tasks[0].arguments = {"--realtime"};
  EXPECT_THAT(SlurmScript("out", tasks, {}),
              AllOf(HasSubstr("--exclusive"), HasSubstr("--cpus-per-task=2")));
}

TEST(Peers, AreNamedAfterSequences) {
  const TestFolder folder;
  EXPECT_THAT(ParsePeer("orb").message(), HasSubstr("NAME=FOLDER"));
  EXPECT_THAT(ParsePeer("orb=/no/such").message(), HasSubstr("no such folder"));
  const StatusOr<Peer> peer = ParsePeer("orb=" + folder.path().string());
  ASSERT_TRUE(peer.ok());
  BenchResults results = TestResults();
  results.plan.folders = {{"walking", (folder / "data").string()}};
  std::filesystem::create_directories(folder / "data");
  std::string images, truth, kitti;
  for (int i = 0; i < 20; ++i) {
    const std::string t = std::to_string(1000 + 0.1 * i), x = std::to_string(0.01 * i * i);
    images += fmt::format("{0} rgb/{0}.png {0} depth/{0}.png\n", t);
    truth += fmt::format("{} {} 0 0 0 0 0 1\n", t, x);
    kitti += fmt::format("1 0 0 {} 0 1 0 0 0 0 1 0\n", x);
  }
  folder.Write("data/associations.txt", images);
  folder.Write("data/groundtruth.txt", truth);
  folder.Write("walking_1.txt", truth);
  folder.Write("walking_2.kitti", kitti);
  folder.Write("walking_3.txt", "1 2 3\n");
  folder.Write("walking_home.txt", truth);
  ASSERT_TRUE(AddPeer(*peer, results).ok());
  const std::vector<const TaskResult*> runs = results.Of("walking", "orb");
  ASSERT_EQ(runs.size(), 3u);
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(runs[i]->ok()) << runs[i]->reason;
    EXPECT_NEAR(runs[i]->ate_m->rmse, 0, 1e-9);
    EXPECT_EQ(*runs[i]->coverage, 1);
  }
  EXPECT_THAT(runs[2]->reason, HasSubstr("is no pose"));
  EXPECT_FALSE(AddPeer({"full", folder.path()}, results).ok());
  ASSERT_TRUE(AddPeer({"empty", folder / "data"}, results).ok());
  EXPECT_THAT(results.peer_notes[0], HasSubstr("no file"));
}

TEST(FramesCsv, IsReadByTheNamesOfItsColumns) {
  const TestFolder folder;
  const auto frames =
      ReadFramesCsv(folder.Write("frames.csv",
                                 "frame,time_s,state,points_static,points_object,total_ms,note\n"
                                 "0,5.5,tracking,30,10,7.5,\n1,5.6,missing,,,,\"a, b\"\n"));
  ASSERT_TRUE(frames.ok()) << frames.message();
  ASSERT_EQ(frames->size(), 2u);
  EXPECT_EQ(*(*frames)[0].static_share, 0.75);
  EXPECT_EQ(*(*frames)[0].latency_ms, 7.5);
  EXPECT_EQ((*frames)[1].state, "missing");
  EXPECT_FALSE((*frames)[1].latency_ms.has_value());
  EXPECT_FALSE(ReadFramesCsv(folder / "absent.csv").ok());
}

}  // namespace
}  // namespace msf
