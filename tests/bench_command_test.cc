// msf-slam bench as a user meets it: crashes, hangs, SIGKILL, reports, other systems, Slurm.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "io/test_folder.h"
#include "tests/program.h"

namespace msf {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr char kSequences[] =
    "sequences:\n"
    "  - {name: walking, scenario: walking_xyz, frames: 12, calm: calm}\n"
    "  - {name: calm, scenario: walking_xyz, frames: 12, without_actors: true}\n";

// All tests render the sequences once, into one folder.
class BenchTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    shared_ = fs::path(testing::TempDir()) / ("msf_bench_sequences_" + std::to_string(getpid()));
  }
  static void TearDownTestSuite() {
    std::error_code ignored;
    fs::remove_all(shared_, ignored);
  }

  std::string Path(const std::string& name) const { return (folder_ / name).string(); }
  std::string Suite(const std::string& name, const std::string& variants,
                    const std::string& more = "") const {
    return folder_.Write(name + ".yaml", kSequences + ("variants:\n" + variants) + more).string();
  }
  std::string Script(const std::string& name, const std::string& lines) const {
    const fs::path file = folder_.Write(name, "#!/bin/sh\n" + lines);
    fs::permissions(file, fs::perms::owner_all);
    return file.string();
  }
  Outcome Bench(const std::string& suite, const std::string& out,
                const std::string& options = "") const {
    return RunProgram("bench " + suite + " --out " + Path(out) + " --rendered " + shared_.string() +
                      " " + options);
  }
  nlohmann::json Results(const std::string& out) const {
    return nlohmann::json::parse(ReadWholeFile(folder_ / (out + "/results.json")));
  }

  static inline fs::path shared_;
  const TestFolder folder_;
};

constexpr char kOffAndFull[] =
    "  - {name: \"off\", dynamic: \"off\"}\n  - {name: full, dynamic: full, detector: none}\n";

TEST_F(BenchTest, CrashesAndHangsAreReportedAndTheRestCompletes) {
  const std::string suite = Suite("s", std::string(kOffAndFull) + "  - {name: crash, program: " +
                                           Script("crash", "kill -SEGV $$\n") +
                                           "}\n  - {name: hang, time_limit_s: 0.5, program: " +
                                           Script("hang", "exec sleep 1000\n") + "}\n");
  const Outcome outcome = Bench(suite, "out", "--jobs 2");
  ExpectSentence(outcome, "4 of 8 tasks did not succeed");
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("walking/crash/0: crashed: killed by signal 11"),
                                    HasSubstr("calm/hang/0: timed_out"), HasSubstr("8/8")));
  int num_ok = 0;
  const nlohmann::json results = Results("out");
  for (const auto& task : results.at("tasks")) {
    if (task.at("status") != "ok") continue;
    ++num_ok;
    EXPECT_EQ(task.at("coverage"), 1) << task;
    EXPECT_LT(task.at("ate_m").at("rmse").get<double>(), 0.01);
  }
  EXPECT_EQ(num_ok, 4);
  const std::string markdown = ReadWholeFile(folder_ / "out/report.md");
  EXPECT_THAT(markdown, AllOf(HasSubstr("0 of 1 ok: 1 crashed"), HasSubstr("1 timed out"),
                              HasSubstr("Table 5"), HasSubstr("Table 8")));
  EXPECT_TRUE(fs::exists(folder_ / "out/tables/table5.csv"));
  EXPECT_TRUE(fs::exists(folder_ / "out/figures/figure5_walking.svg"));
}

// The first task of a variant kills the bench with SIGKILL the first time it is run.
TEST_F(BenchTest, KilledAndResumedItGivesTheSame) {
  const std::string killer = Script(
      "killer", "if [ ! -e " + Path("killed") + " ]; then touch " + Path("killed") +
                    "; kill -KILL $(awk '{ print $4 }' /proc/$PPID/stat); exec sleep 1000; fi\n" +
                    "exec " MSF_PROGRAM " \"$@\"\n");
  const std::string suite = Suite(
      "s", std::string(kOffAndFull) + "  - {name: fatal, dynamic: \"off\", program: " + killer +
               "}\n  - {name: again, dynamic: \"off\"}\n");
  EXPECT_NE(Bench(suite, "killed_out").exit_code, 0);
  ASSERT_TRUE(fs::exists(folder_ / "killed"));
  EXPECT_FALSE(fs::exists(folder_ / "killed_out/results.json"));
  EXPECT_TRUE(fs::exists(folder_ / "killed_out/tasks/walking/off/0/result.json"));
  ExpectSentence(Bench(suite, "killed_out"), "--resume");
  const Outcome resumed = Bench(suite, "killed_out", "--resume");
  ASSERT_EQ(resumed.exit_code, 0) << resumed.output;
  EXPECT_THAT(resumed.output, HasSubstr("6 of 8 tasks are open"));
  const Outcome whole = Bench(suite, "whole_out", "--jobs 2");
  ASSERT_EQ(whole.exit_code, 0) << whole.output;
  for (const char* file : {"results.json", "tables/overview.csv", "tables/table5.csv",
                           "tables/table6.csv", "tables/table7.csv"}) {
    EXPECT_EQ(ReadWholeFile(folder_ / "killed_out" / file),
              ReadWholeFile(folder_ / "whole_out" / file))
        << file;
  }
  EXPECT_THAT(Bench(suite, "whole_out", "--resume").output, HasSubstr("0 of 8 tasks are open"));
}

TEST_F(BenchTest, ComparesTwoResults) {
  const std::string suite = Suite("s", "  - {name: \"off\", dynamic: \"off\"}\n");
  ASSERT_EQ(Bench(suite, "out").exit_code, 0);
  const std::string before = Path("out/results.json");
  const Outcome same = RunProgram("bench compare " + before + " " + before + " --tolerance 0.01");
  EXPECT_EQ(same.exit_code, 0) << same.output;
  nlohmann::json worse = Results("out");
  worse["tasks"][0]["ate_m"]["rmse"] = 0.5;
  folder_.Write("worse.json", worse.dump());
  ExpectSentence(RunProgram("bench compare " + before + " " + Path("worse.json")),
                 "have become worse");
  ExpectSentence(RunProgram("bench compare " + before + " " + Path("absent.json")), "absent.json");
}

TEST_F(BenchTest, TakesTrajectoriesOfOtherSystems) {
  const std::string suite = Suite("s", "  - {name: \"off\", dynamic: \"off\"}\n");
  fs::create_directories(folder_ / "orb");
  ASSERT_EQ(Bench(suite, "out").exit_code, 0);
  fs::copy_file(folder_ / "out/tasks/walking/off/0/trajectory.txt", folder_ / "orb/walking.txt");
  const Outcome outcome = Bench(suite, "out", "--resume --peers ORB=" + Path("orb"));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  const nlohmann::json tasks = Results("out").at("tasks");
  ASSERT_EQ(tasks.size(), 3u);
  EXPECT_EQ(tasks[2].at("variant"), "ORB");
  EXPECT_NEAR(tasks[2].at("ate_m").at("rmse").get<double>(),
              tasks[0].at("ate_m").at("rmse").get<double>(), 1e-6);
  EXPECT_THAT(ReadWholeFile(folder_ / "out/tables/table7.csv"), HasSubstr("\"measured, ORB\""));
}

TEST_F(BenchTest, MistakesAreSentences) {
  ExpectSentence(RunProgram("bench"), "name a suite");
  ExpectSentence(Bench("no_such_suite", "o"), "tum_dynamic");
  ExpectSentence(Bench(folder_.Write("bad.yaml", "repeat: 1\n").string(), "o"),
                 "unknown option 'repeat'");
  ExpectSentence(Bench(Suite("v", "  - {name: v, set: [dynamic.no_such_key=1]}\n"), "o"),
                 "variant 'v': unknown option 'no_such_key'");
  const std::string good = Suite("s", kOffAndFull);
  ExpectSentence(Bench(good, "o", "--root " + Path("absent")), "no such folder of data sets");
  ExpectSentence(Bench(good, "o", "--variants off,none"), "no variant 'none', only: off, full");
  ExpectSentence(Bench(good, "o", "--sequences none"), "no sequence 'none'");
  ExpectSentence(Bench(good, "o", "--peers x"), "NAME=FOLDER");
  ExpectSentence(RunProgram("bench " + good + " --out /proc/no"), "cannot be written there");
  const std::string missing =
      folder_
          .Write("missing.yaml",
                 "sequences: [{name: m, folder: not_here, address: 'https://example.org/m'}]\n"
                 "variants: [{name: v}]\n")
          .string();
  const Outcome skipped = Bench(missing, "missing");
  ExpectSentence(skipped, "nothing was run");
  EXPECT_THAT(skipped.output, HasSubstr("SKIPPED m: the folder 'not_here'"));
  EXPECT_THAT(ReadWholeFile(folder_ / "missing/report.html"), HasSubstr("https://example.org/m"));
}

// Chromium says on its log what a page's console would say.
TEST_F(BenchTest, ReportOpensInABrowser) {
  if (RunShell("command -v chromium").exit_code != 0)
    GTEST_SKIP() << "chromium is not installed, so the report was not opened in it";
  const std::string suite =
      Suite("s", "  - {name: \"off\", dynamic: \"off\"}\n  - {name: full, dynamic: full}\n");
  const Outcome bench = Bench(suite, "out", "--jobs 2");
  ASSERT_EQ(bench.exit_code, 0) << bench.output;
  const std::string screenshot = Path("report.png");
  const std::string browser =
      "chromium --headless=new --no-sandbox --disable-gpu --disable-dev-shm-usage "
      "--hide-scrollbars "
      "--no-first-run --user-data-dir=" +
      Path("profile") + " --enable-logging=stderr --window-size=1280,9000 ";
  const Outcome shown =
      RunShell(browser + "--screenshot=" + screenshot + " file://" + Path("out/report.html"));
  EXPECT_THAT(shown.output, Not(HasSubstr("CONSOLE"))) << shown.output;
  ASSERT_TRUE(fs::exists(screenshot)) << shown.output;
  EXPECT_GT(fs::file_size(screenshot), 100'000u) << "a page without its figures";
  // All pictures were decoded, and nothing is wider than the window.
  const std::string report = ReadWholeFile(folder_ / "out/report.html");
  const size_t end = report.rfind("</body>");
  folder_.Write(
      "out/probe.html",
      report.substr(0, end) +
          "<script>addEventListener('load', () => { const all = [...document.images];"
          "console.log('PROBE ' + all.length + ' ' + all.filter(i => !i.naturalWidth).length"
          " + ' ' + (document.documentElement.scrollWidth <= innerWidth)); });</script>" +
          report.substr(end));
  const Outcome probe =
      RunShell(browser + "--screenshot=" + Path("probe.png") + " file://" + Path("out/probe.html"));
  EXPECT_THAT(probe.output, testing::ContainsRegex("PROBE 1[0-9] 0 true")) << probe.output;
}

// A Slurm of one node, up as long as the object lives.
class SlurmNode {
 public:
  explicit SlurmNode(std::string folder) : folder_(std::move(folder)) {
    start_ = RunShell(script_ + "start " + folder_);
  }
  ~SlurmNode() { RunShell(script_ + "stop " + folder_); }
  SlurmNode(const SlurmNode&) = delete;
  SlurmNode& operator=(const SlurmNode&) = delete;
  const Outcome& start() const { return start_; }

 private:
  const std::string script_ = "PATH=$PATH:/usr/sbin " MSF_SOURCE_DIR "/tests/slurm_node ";
  const std::string folder_;
  Outcome start_;
};

TEST_F(BenchTest, SlurmGivesWhatJobsGive) {
  if (RunShell(
          "PATH=$PATH:/usr/sbin; command -v slurmctld && command -v slurmd && command -v sbatch")
          .exit_code != 0)
    GTEST_SKIP() << "slurm-wlm is not installed, so no job array was run";
  const std::string suite = Suite("s", kOffAndFull, "repeats: 5\n");
  const Outcome local = Bench(suite, "local", "--jobs 2");
  ASSERT_EQ(local.exit_code, 0) << local.output;
  const std::string nothing = folder_.Write("nothing.conf", "").string();
  ExpectSentence(RunShell("SLURM_CONF=" + nothing + " " MSF_PROGRAM " bench " + suite + " --out " +
                          Path("no") + " --rendered " + shared_.string() + " --slurm"),
                 "Slurm cannot be asked");
  const SlurmNode node(Path("slurm"));
  ASSERT_EQ(node.start().exit_code, 0) << node.start().output;
  const Outcome array =
      RunShell("SLURM_CONF=" + Path("slurm/slurm.conf") + " " MSF_PROGRAM " bench " + suite +
               " --out " + Path("array") + " --rendered " + shared_.string() + " --slurm");
  ASSERT_EQ(array.exit_code, 0) << array.output;
  EXPECT_EQ(Results("array").at("tasks").size(), 20u);
  EXPECT_EQ(ReadWholeFile(folder_ / "array/results.json"),
            ReadWholeFile(folder_ / "local/results.json"));
  EXPECT_THAT(ReadWholeFile(folder_ / "array/slurm/array0.sh"), HasSubstr("--array=0-19"));
}

}  // namespace
}  // namespace msf
