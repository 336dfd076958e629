// msf-slam evaluate: how far estimated trajectories are from the truth.
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/command.h"
#include "evaluation/evaluation.h"
#include "evaluation/evaluation_report.h"
#include "evaluation/trajectory_plot.h"
#include "io/tum_dataset.h"
#include "util/atomic_file.h"

namespace msf {
namespace {

namespace fs = std::filesystem;

struct EvaluateArguments {
  fs::path truth_file;
  std::vector<fs::path> estimate_files;
  bool free_scale = false;
  fs::path json_file;
  fs::path plot_folder;
  size_t num_frames = 0;
  fs::path dataset_folder;
};

std::optional<size_t> NumInputFrames(const EvaluateArguments& arguments) {
  if (arguments.num_frames > 0) return arguments.num_frames;
  if (arguments.dataset_folder.empty()) return std::nullopt;
  return Require(CountFrames(arguments.dataset_folder));
}

// Short names that tell the estimates apart: file names, or whole paths where those repeat.
std::vector<std::string> NamesOf(const std::vector<fs::path>& files) {
  std::vector<std::string> names;
  for (const fs::path& file : files) {
    size_t same = 0;
    for (const fs::path& other : files) same += other.stem() == file.stem();
    names.push_back(same == 1 ? file.stem().string() : file.string());
  }
  return names;
}

void WritePlots(const fs::path& folder, const Trajectory& truth,
                const std::vector<Evaluation>& evaluations) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw CommandFailure(folder.string() + ": cannot be made: " + error.message());
  Require(WriteFileAtomically(folder / "trajectory.svg", PlotTrajectories(truth, evaluations)));
  Require(WriteFileAtomically(folder / "error.svg", PlotErrors(evaluations)));
  std::cout << "plots: " << (folder / "trajectory.svg").string() << ", "
            << (folder / "error.svg").string() << "\n";
}

void WriteJson(const EvaluateArguments& arguments, const std::vector<Evaluation>& evaluations) {
  nlohmann::json json = {{"groundtruth", arguments.truth_file.string()},
                         {"alignment", arguments.free_scale ? "sim3" : "se3"},
                         {"estimates", nlohmann::json::array()}};
  for (const Evaluation& evaluation : evaluations)
    json["estimates"].push_back(EvaluationToJson(evaluation));
  Require(WriteFileAtomically(arguments.json_file, json.dump(2) + "\n"));
}

void Evaluate(const EvaluateArguments& arguments) {
  EvaluationOptions options;
  options.scale = arguments.free_scale ? ScaleEstimation::kFree : ScaleEstimation::kFixed;
  options.num_input_frames = NumInputFrames(arguments);
  const Trajectory truth = Require(ReadTrajectory(arguments.truth_file));
  const std::vector<std::string> names = NamesOf(arguments.estimate_files);
  std::vector<Evaluation> evaluations;
  for (size_t i = 0; i < names.size(); ++i) {
    const Trajectory estimate = Require(ReadTrajectory(arguments.estimate_files[i]));
    evaluations.push_back(Require(EvaluateTrajectory(names[i], truth, estimate, options)));
  }
  std::cout << FormatTable(evaluations);
  if (!options.num_input_frames)
    std::cout << "The coverage needs the number of input frames: --dataset DIR or --frames N.\n";
  if (!arguments.json_file.empty()) WriteJson(arguments, evaluations);
  if (!arguments.plot_folder.empty()) WritePlots(arguments.plot_folder, truth, evaluations);
}

}  // namespace

void AddEvaluateCommand(CLI::App& app) {
  auto arguments = std::make_shared<EvaluateArguments>();
  CLI::App* command = app.add_subcommand(
      "evaluate", "Compare trajectories with the ground truth: ATE, RPE, coverage");
  command->add_option("groundtruth", arguments->truth_file, "true trajectory, TUM text")
      ->required();
  command->add_option("estimates", arguments->estimate_files, "estimated trajectories, TUM text")
      ->required();
  command->add_flag("--scale", arguments->free_scale,
                    "align with scale (Sim3), for monocular estimates");
  command->add_option("--json", arguments->json_file, "write all figures to this file");
  command->add_option("--plots", arguments->plot_folder,
                      "write trajectory.svg and error.svg to this folder");
  CLI::Option* frames = command->add_option("--frames", arguments->num_frames,
                                            "number of input frames, for the coverage");
  frames->check(CLI::PositiveNumber);
  command
      ->add_option("--dataset", arguments->dataset_folder,
                   "count the input frames of this data set, for the coverage")
      ->excludes(frames);
  command->callback([arguments] { Evaluate(*arguments); });
}

}  // namespace msf
