// msf-slam evaluate: how far estimated trajectories are from the truth.
#include <cmath>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "apps/arguments.h"
#include "apps/command.h"
#include "evaluation/evaluation.h"
#include "evaluation/evaluation_report.h"
#include "evaluation/json_text.h"
#include "evaluation/mask_score.h"
#include "evaluation/statistics.h"
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
  fs::path mask_folder;
  std::vector<fs::path> label_files;
};

std::optional<size_t> NumInputFrames(const EvaluateArguments& arguments) {
  if (arguments.num_frames > 0) return arguments.num_frames;
  if (arguments.dataset_folder.empty()) return std::nullopt;
  return Require(CountFrames(arguments.dataset_folder));
}

// Short names that tell the estimates apart: file names, those of their folders where files are
// called the same, or whole paths.
std::vector<std::string> NamesOf(const std::vector<fs::path>& files) {
  const auto name_by = [&](const std::function<std::string(const fs::path&)>& name) {
    std::vector<std::string> names;
    names.reserve(files.size());
    for (const fs::path& file : files) names.push_back(name(file));
    return names;
  };
  const auto differ = [](const std::vector<std::string>& names) {
    return std::set<std::string>(names.begin(), names.end()).size() == names.size();
  };
  std::vector<std::string> names =
      name_by([](const fs::path& file) { return file.stem().string(); });
  if (!differ(names))
    names = name_by([](const fs::path& file) { return file.parent_path().filename().string(); });
  if (!differ(names)) names = name_by([](const fs::path& file) { return file.string(); });
  return names;
}

void WritePlots(const fs::path& folder, const Trajectory& truth,
                const std::vector<Evaluation>& evaluations) {
  MakeFolder(folder);
  Require(WriteFileAtomically(folder / "trajectory.svg", PlotTrajectories(truth, evaluations)));
  Require(WriteFileAtomically(folder / "error.svg", PlotErrors(evaluations)));
  std::cout << "plots: " << (folder / "trajectory.svg").string() << ", "
            << (folder / "error.svg").string() << "\n";
}

void WriteJson(const EvaluateArguments& arguments, const std::vector<Evaluation>& evaluations,
               const std::vector<MaskScore>& scores) {
  nlohmann::json json = nlohmann::json::object();
  if (!arguments.truth_file.empty()) {
    json = {{"groundtruth", arguments.truth_file.string()},
            {"alignment", arguments.free_scale ? "sim3" : "se3"},
            {"estimates", nlohmann::json::array()}};
  }
  for (const Evaluation& evaluation : evaluations)
    json["estimates"].push_back(EvaluationToJson(evaluation));
  for (const MaskScore& score : scores) json["masks"].push_back(MaskScoreToJson(score));
  Require(WriteFileAtomically(arguments.json_file, JsonText(json)));
}

// Numbers of a trajectory may be so large that their squares are none.
void RequireFinite(const Evaluation& evaluation) {
  for (const ErrorSeries* series :
       {&evaluation.absolute.translation_m, &evaluation.per_frame.translation_m,
        &evaluation.per_frame.rotation_rad, &evaluation.per_second.translation_m,
        &evaluation.per_second.rotation_rad}) {
    if (series->value.empty() || std::isfinite(ComputeStatistics(series->value).rmse)) continue;
    throw CommandFailure(evaluation.name +
                         ": the errors are no finite numbers; look for senseless positions in the "
                         "trajectory and in the true one");
  }
}

std::vector<Evaluation> EvaluateTrajectories(const EvaluateArguments& arguments) {
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
  for (const Evaluation& evaluation : evaluations) RequireFinite(evaluation);
  if (!arguments.plot_folder.empty()) WritePlots(arguments.plot_folder, truth, evaluations);
  return evaluations;
}

// The labels of a run lie beside its trajectory unless they are named.
std::vector<MaskScore> ScoreMasks(const EvaluateArguments& arguments) {
  std::vector<fs::path> files = arguments.label_files;
  if (files.empty()) {
    for (const fs::path& estimate : arguments.estimate_files)
      files.push_back(estimate.parent_path() / "labels.csv");
  }
  if (files.empty())
    throw CommandFailure("--masks needs --labels FILE, the labels.csv of a run with --labels");
  std::vector<MaskScore> scores;
  for (const fs::path& file : files) {
    const std::string name =
        file.parent_path().empty() ? file.stem().string() : file.parent_path().string();
    scores.push_back(Require(ScoreAgainstMasks(name, file, arguments.mask_folder)));
    std::cout << FormatMaskScore(scores.back());
  }
  return scores;
}

void Evaluate(const EvaluateArguments& arguments) {
  if (arguments.estimate_files.empty() &&
      (!arguments.truth_file.empty() || arguments.mask_folder.empty()))
    throw CommandFailure(
        "name the true trajectory and at least one estimated one, or --masks DIR and --labels "
        "FILE");
  RequireWritableFile(arguments.json_file);
  RequireWritableFolder(arguments.plot_folder);
  std::vector<Evaluation> evaluations;
  std::vector<MaskScore> scores;
  if (!arguments.estimate_files.empty()) evaluations = EvaluateTrajectories(arguments);
  if (!arguments.mask_folder.empty()) scores = ScoreMasks(arguments);
  if (!arguments.json_file.empty()) WriteJson(arguments, evaluations, scores);
}

}  // namespace

void AddEvaluateCommand(CLI::App& app) {
  auto arguments = std::make_shared<EvaluateArguments>();
  CLI::App* command = app.add_subcommand(
      "evaluate",
      "Compare with the truth: trajectories (ATE, RPE, coverage) and what was found to move");
  command->add_option("groundtruth", arguments->truth_file, "true trajectory, TUM text");
  command->add_option("estimates", arguments->estimate_files, "estimated trajectories, TUM text");
  command->add_flag("--scale", arguments->free_scale,
                    "align with scale (Sim3), for monocular estimates");
  command->add_option("--json", arguments->json_file, "write all figures to this file");
  command->add_option("--plots", arguments->plot_folder,
                      "write trajectory.svg and error.svg to this folder");
  CLI::Option* frames = command->add_option("--frames", arguments->num_frames,
                                            "number of input frames, for the coverage");
  frames->check(CLI::Range(1, 1000000000));
  command
      ->add_option("--dataset", arguments->dataset_folder,
                   "count the input frames of this data set, for the coverage")
      ->excludes(frames);
  CLI::Option* masks =
      command->add_option("--masks", arguments->mask_folder,
                          "score the removal of moving things: folder of true masks (TIME.png, 0 = "
                          "static), or a data set with mask/");
  command
      ->add_option(
          "--labels", arguments->label_files,
          "labels.csv of runs with --labels; default: those beside the estimated trajectories")
      ->needs(masks);
  command->callback([arguments] { Evaluate(*arguments); });
}

}  // namespace msf
