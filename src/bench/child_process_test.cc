#include "bench/child_process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>

#include <csignal>

#include "bench/energy_counter.h"
#include "io/test_folder.h"

namespace msf {
namespace {

using testing::HasSubstr;

class ChildProcessTest : public ::testing::Test {
 protected:
  ProcessSpec Shell(const std::string& line, double time_limit_s = 0) const {
    return {{"sh", "-c", line}, folder_ / "log.txt", time_limit_s};
  }
  const TestFolder folder_;
};

TEST_F(ChildProcessTest, TellsHowAProgramEnded) {
  EXPECT_TRUE(RunProcess(Shell("echo said; echo loudly >&2")).ok());
  EXPECT_EQ(ReadWholeFile(folder_ / "log.txt"), "said\nloudly\n");
  EXPECT_EQ(LastLine(folder_ / "log.txt"), "loudly");
  EXPECT_EQ(RunProcess(Shell("exit 3")).ToString(), "exit code 3");
  const ProcessEnd crash = RunProcess(Shell("kill -SEGV $$"));
  EXPECT_EQ(crash.kind, ProcessEnd::Kind::kKilled);
  EXPECT_EQ(crash.code, SIGSEGV);
  EXPECT_THAT(crash.ToString(), HasSubstr("Segmentation fault"));
  EXPECT_EQ(RunProcess({{"/no/such/program"}, folder_ / "log.txt", 0}).code, 127);
  EXPECT_EQ(RunProcess({{"true"}, folder_ / "no/log.txt", 0}).kind, ProcessEnd::Kind::kNotStarted);
}

// However long it takes here, it would take longer without the limit.
TEST_F(ChildProcessTest, KillsWhatHangsAndWhatThatStarted) {
  const ProcessEnd end =
      RunProcess(Shell("sleep 1000 & echo $! > " + (folder_ / "pid").string() + "; wait", 0.3));
  EXPECT_EQ(end.kind, ProcessEnd::Kind::kTimedOut);
  EXPECT_THAT(end.ToString(), HasSubstr("time limit"));
  const std::string pid = ReadWholeFile(folder_ / "pid");
  if (pid.empty()) return;  // killed before it could start anything
  // Gone, or dead and waiting for init to take notice; a signal takes a moment to arrive.
  const std::string file = "/proc/" + pid.substr(0, pid.find('\n')) + "/status";
  const auto is_gone = [&] {
    const std::string status = ReadWholeFile(file);
    return status.empty() || status.find("State:\tZ") != std::string::npos;
  };
  for (int i = 0; i < 3000 && !is_gone(); ++i) poll(nullptr, 0, 10);
  EXPECT_TRUE(is_gone());
}

TEST_F(ChildProcessTest, RunsSeveralAtATimeAndReportsEach) {
  std::vector<ProcessSpec> specs;
  specs.reserve(7);
  for (int i = 0; i < 7; ++i) specs.push_back(Shell("exit " + std::to_string(i)));
  specs[3].time_limit_s = 100;
  std::vector<int> codes(7, -1);
  int ticks = 0;
  RunProcesses(
      specs, 3, [&](size_t i, const ProcessEnd& end) { codes[i] = end.code; }, [&] { ++ticks; });
  EXPECT_THAT(codes, testing::ElementsAre(0, 1, 2, 3, 4, 5, 6));
  EXPECT_GT(ticks, 0);
}

TEST(EnergyCounter, AddsUpPackagesOnly) {
  const TestFolder folder;
  for (const char* zone : {"intel-rapl:0", "intel-rapl:0:0", "intel-rapl:1", "dtpm"})
    std::filesystem::create_directories(folder / zone);
  folder.Write("intel-rapl:0/energy_uj", "1000000\n");
  folder.Write("intel-rapl:0:0/energy_uj", "5\n");
  folder.Write("intel-rapl:1/energy_uj", "9000000\n");
  folder.Write("intel-rapl:1/max_energy_range_uj", "10000000\n");
  const EnergyCounter counter(folder.path());
  folder.Write("intel-rapl:0/energy_uj", "3500000\n");
  folder.Write("intel-rapl:1/energy_uj", "1000000\n");  // over its end
  ASSERT_TRUE(counter.Joules().has_value());
  EXPECT_NEAR(*counter.Joules(), 2.5 + 2, 1e-9);
  EXPECT_FALSE(EnergyCounter(folder / "nothing").Joules().has_value());
}

}  // namespace
}  // namespace msf
