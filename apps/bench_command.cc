// msf-slam bench: runs a suite and makes its report; bench compare: has anything become worse?
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/arguments.h"
#include "apps/command.h"
#include "apps/run_arguments.h"
#include "bench/bench_run.h"
#include "bench/comparison.h"
#include "bench/peers.h"
#include "bench/report.h"
#include "bench/slurm.h"
#include "bench/task_run.h"
#include "evaluation/json_text.h"
#include "util/atomic_file.h"
#include "util/options.h"

namespace msf {
namespace {

namespace fs = std::filesystem;

// Looked for after --root and MSF_SLAM_DATASETS: where the project's own scripts unpack sequences.
constexpr const char* kUsualRoots[] = {"data", "build/data", "build/sequences",
                                       "build/test/sequences"};

struct BenchArguments {
  std::string suite;
  fs::path out;
  int jobs = 1;
  bool resume = false;
  bool retry_failed = false;
  bool slurm = false;
  std::string slurm_options;
  std::vector<fs::path> roots;
  fs::path sequence_folder;
  std::vector<std::string> sequences, variants;
  std::vector<std::string> peers;
  double time_limit_s = 0;
  int max_frames = 0;
  int repeats = 0;
  std::string task;
};

struct CompareArguments {
  fs::path before, after;
  ComparisonOptions options;
};

// A variant with a misspelt option would fail as often as it is run; better before the first run.
void CheckVariants(const Suite& suite) {
  for (const SuiteVariant& variant : suite.variants) {
    if (!variant.program.empty()) continue;  // another build may know other options
    RunArguments arguments;
    arguments.config_file = variant.config;
    arguments.assignments = variant.set;
    arguments.dynamic = variant.dynamic;
    arguments.detector = variant.detector;
    try {
      ResolveOptions(arguments);
    } catch (const CommandFailure& failure) {
      throw CommandFailure(fmt::format("variant '{}': {}", variant.name, failure.what()));
    }
  }
}

Suite ResolveSuite(const BenchArguments& arguments) {
  if (arguments.suite.empty()) {
    throw CommandFailure(fmt::format("name a suite: a YAML file, or one of those that ship: {}",
                                     fmt::join(SuiteNames(), ", ")));
  }
  Suite suite = Require(LoadSuite(arguments.suite));
  Require(suite.KeepOnly(arguments.sequences, arguments.variants));
  if (arguments.max_frames > 0) suite.max_frames = arguments.max_frames;
  if (arguments.repeats > 0) {
    suite.repeats = arguments.repeats;
    for (SuiteVariant& variant : suite.variants) variant.repeats = 0;
  }
  // What is not going to be looked at need not be rendered.
  for (SuiteSequence& sequence : suite.sequences) {
    if (!sequence.scenario.empty() && suite.max_frames > 0 &&
        (sequence.frames == 0 || sequence.frames > suite.max_frames))
      sequence.frames = suite.max_frames;
  }
  CheckVariants(suite);
  return suite;
}

Plan ResolvePlan(const BenchArguments& arguments, const Suite& suite, const BuildInfo& build) {
  PlanOptions options;
  for (const fs::path& root : arguments.roots) {
    std::error_code ignored;
    if (!fs::is_directory(root, ignored))
      throw CommandFailure(root.string() + ": there is no such folder of data sets");
    options.roots.push_back(fs::absolute(root));
  }
  for (const fs::path& root : RootsOfEnvironment()) options.roots.push_back(fs::absolute(root));
  for (const char* root : kUsualRoots) options.roots.push_back(fs::absolute(root));
  options.sequence_folder = fs::absolute(
      arguments.sequence_folder.empty() ? arguments.out / "sequences" : arguments.sequence_folder);
  options.build = build.ToString();
  options.time_limit_s = arguments.time_limit_s;
  return MakePlan(suite, options);
}

void RunOpenTasks(const BenchArguments& arguments, const Plan& plan) {
  const std::vector<Task> open = OpenTasks(arguments.out, plan, arguments.retry_failed);
  std::cerr << fmt::format("bench: {} of {} tasks are open\n", open.size(), plan.tasks.size());
  ForgetResults(arguments.out, open);
  if (arguments.slurm) {
    Require(RunTasksOnSlurm(arguments.out, open, {arguments.slurm_options, 0}));
  } else {
    RunTasks(arguments.out, open, arguments.jobs, plan.tasks.size());
  }
}

void PrintMissing(const Plan& plan) {
  for (const MissingSequence& missing : plan.missing)
    std::cerr << "bench: SKIPPED " << DescribeMissing(missing) << "\n";
}

// The outcome in a few lines, and as the exit code.
void Conclude(const fs::path& out, const BenchResults& results) {
  const ReportFacts facts = GatherFacts(results);
  PrintMissing(results.plan);
  for (const std::string& problem : facts.problems) std::cout << "PROBLEM " << problem << "\n";
  std::cout << "report: " << (out / "report.html").string() << "\n";
  if (results.plan.tasks.empty())
    throw CommandFailure("nothing was run: no sequence of the suite is here");
  for (const MissingSequence& missing : results.plan.missing) {
    if (!missing.reason.empty()) throw CommandFailure(DescribeMissing(missing));
  }
  if (!facts.problems.empty()) {
    throw CommandFailure(fmt::format("{} of {} tasks did not succeed; the report says why",
                                     facts.problems.size(), results.results.size()));
  }
}

// What the processes that bench starts do.
void DoTask(const BenchArguments& arguments) {
  const Plan plan = Require(ReadPlan(arguments.out / "plan.json"));
  const Task* task = plan.Find(arguments.task);
  if (task == nullptr) throw CommandFailure("the plan has no task '" + arguments.task + "'");
  Require(RunTask(arguments.out, *task));
}

void Bench(BenchArguments& arguments) {
  BenchResults results;
  results.suite = ResolveSuite(arguments);
  if (arguments.out.empty()) arguments.out = fs::path("out") / "bench" / results.suite.name;
  arguments.out = fs::absolute(arguments.out).lexically_normal();
  results.build = ReadBuildInfo();
  results.machine = ReadMachine();
  std::vector<Peer> peers;
  for (const std::string& peer : arguments.peers) peers.push_back(Require(ParsePeer(peer)));
  results.plan = ResolvePlan(arguments, results.suite, results.build);
  PrintMissing(results.plan);
  Require(PrepareBenchFolder(arguments.out, arguments.resume));
  Require(WriteFileAtomically(arguments.out / "suite.yaml",
                              YAML::Dump(OptionsToYaml(results.suite)) + "\n"));
  RenderSequences(arguments.out, arguments.jobs, results.plan);
  Require(WriteFileAtomically(arguments.out / "plan.json", JsonText(PlanToJson(results.plan))));
  RunOpenTasks(arguments, results.plan);
  results.results = CollectResults(arguments.out, results.plan);
  for (const Peer& peer : peers) Require(AddPeer(peer, results));
  Require(WriteResults(arguments.out, results));
  Require(WriteReport(arguments.out, results));
  Conclude(arguments.out, results);
}

void Compare(const CompareArguments& arguments) {
  const Comparison comparison =
      Require(CompareResults(arguments.before, arguments.after, arguments.options));
  std::cout << FormatComparison(comparison);
  if (comparison.NumRegressions() > 0) throw CommandFailure("the results have become worse");
}

void AddCompareCommand(CLI::App& bench) {
  const auto arguments = std::make_shared<CompareArguments>();
  CLI::App* command = bench.add_subcommand(
      "compare", "Compare two results.json; exits with 1 when the second one is worse");
  command->add_option("before", arguments->before, "results.json of a bench")->required();
  command->add_option("after", arguments->after, "results.json of a later one")->required();
  ComparisonOptions& options = arguments->options;
  command->add_option("--tolerance", options.tolerance, "share by which a median error may grow")
      ->capture_default_str()
      ->check(NumberFrom(0, 1000));
  command->add_option("--slack", options.slack_m, "metres by which it may grow where that is more")
      ->capture_default_str()
      ->check(NumberFrom(0, 1000));
  command
      ->add_option("--coverage-tolerance", options.coverage_tolerance,
                   "share of the frames by which the coverage may fall, and mAP50 by itself")
      ->capture_default_str()
      ->check(NumberFrom(0, 1000));
  command
      ->add_option("--time-tolerance", options.time_tolerance,
                   "share by which the median latency may grow; 0: times are not compared")
      ->capture_default_str()
      ->check(NumberFrom(0, 1000));
  command->callback([arguments] { Compare(*arguments); });
}

void AddOptions(CLI::App& command, BenchArguments& arguments) {
  command.add_option("SUITE", arguments.suite,
                     fmt::format("a YAML file or one of: {}", fmt::join(SuiteNames(), ", ")));
  command.add_option("--out", arguments.out,
                     "folder for results and report; default: out/bench/<name of the suite>");
  command.add_option("--jobs", arguments.jobs, "tasks at a time; those in real time run alone")
      ->capture_default_str()
      ->check(CLI::Range(1, 1024));
  command.add_flag("--resume", arguments.resume, "go on in a folder that holds results already");
  command.add_flag("--retry-failed", arguments.retry_failed,
                   "with --resume: run again what did not succeed");
  command
      .add_option("--root", arguments.roots,
                  "folder with data sets; may be repeated. Also: the environment variable "
                  "MSF_SLAM_DATASETS (separated by ':')")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command.add_option("--rendered", arguments.sequence_folder,
                     "where simulated sequences are made and kept; default: OUT/sequences");
  command
      .add_option("--sequences", arguments.sequences, "only these of the suite, separated by ','")
      ->delimiter(',')
      ->allow_extra_args(false);
  command.add_option("--variants", arguments.variants, "only these of the suite, separated by ','")
      ->delimiter(',')
      ->allow_extra_args(false);
  command
      .add_option("--peers", arguments.peers,
                  "NAME=FOLDER with trajectories of another system (TUM, KITTI or EuRoC), named "
                  "after the sequences; may be repeated")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command
      .add_option("--time-limit", arguments.time_limit_s,
                  "of every task, instead of the suite's, s")
      ->check(NumberFrom(0.001, 1e7));
  command
      .add_option("--max-frames", arguments.max_frames, "of every sequence, instead of the suite's")
      ->check(CLI::Range(1, 1000000000));
  command.add_option("--repeats", arguments.repeats, "of every variant, instead of the suite's")
      ->check(CLI::Range(1, 1000));
  CLI::Option* slurm =
      command.add_flag("--slurm", arguments.slurm, "run the tasks as a job array of Slurm");
  command.add_option("--slurm-options", arguments.slurm_options, "further words for sbatch")
      ->needs(slurm);
  command.add_option("--task", arguments.task, "do this task of OUT/plan.json only")
      ->group("");  // for the processes that bench starts itself
}

}  // namespace

void AddBenchCommand(CLI::App& app) {
  const auto arguments = std::make_shared<BenchArguments>();
  CLI::App* command =
      app.add_subcommand("bench", "Run a suite of sequences and variants and make its report");
  AddOptions(*command, *arguments);
  AddCompareCommand(*command);
  command->footer("Keys of a suite, with defaults:\n" + DescribeOptions<Suite>());
  command->callback([arguments, command] {
    if (!command->get_subcommands().empty()) return;
    if (arguments->task.empty())
      Bench(*arguments);
    else
      DoTask(*arguments);
  });
}

}  // namespace msf
