#include "bench/plan.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>

namespace msf {
namespace {

namespace fs = std::filesystem;

// What the suite calls modes, as switches of `run`.
std::vector<std::string> ModeArguments(const std::string& mode) {
  if (mode == "threaded") return {};
  return {"--" + mode};
}

void Append(std::vector<std::string>& to, const std::vector<std::string>& words) {
  to.insert(to.end(), words.begin(), words.end());
}

std::string ReadText(const std::string& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

// How `run` is told about L of table 1.
std::vector<std::string> ThresholdArguments(const SuiteVariant& variant) {
  if (variant.threshold_px <= 0) return {};
  const char* key =
      variant.dynamic == "paper" ? "dynamic.paper_flow_px" : "dynamic.motion.min_residual_px";
  return {"--set", fmt::format("{}={}", key, variant.threshold_px)};
}

std::vector<std::string> RunArgumentsOf(const Suite& suite, const SuiteSequence& sequence,
                                        const SuiteVariant& variant, int repeat) {
  std::vector<std::string> arguments;
  if (!sequence.camera.empty()) Append(arguments, {"--camera", sequence.camera});
  Append(arguments, ModeArguments(ModeOf(suite, variant)));
  if (!variant.config.empty()) Append(arguments, {"--config", variant.config});
  for (const std::string& assignment : variant.set) Append(arguments, {"--set", assignment});
  Append(arguments, ThresholdArguments(variant));
  if (!variant.dynamic.empty()) Append(arguments, {"--dynamic", variant.dynamic});
  if (!variant.detector.empty()) Append(arguments, {"--detector", variant.detector});
  if (suite.max_frames > 0) Append(arguments, {"--max-frames", std::to_string(suite.max_frames)});
  Append(arguments, {"--seed", std::to_string(suite.seed + static_cast<uint64_t>(repeat))});
  return arguments;
}

std::vector<std::string> SimulateArgumentsOf(const SuiteSequence& sequence) {
  std::vector<std::string> arguments = {sequence.scenario, "--seed", std::to_string(sequence.seed)};
  if (sequence.frames > 0) Append(arguments, {"--frames", std::to_string(sequence.frames)});
  if (sequence.without_actors) arguments.emplace_back("--without-actors");
  for (const std::string& setting : sequence.settings) Append(arguments, {"--set", setting});
  return arguments;
}

// The folder of a rendering says how it is made, so that suites can share it.
std::string RenderingName(const SuiteSequence& sequence) {
  const std::string arguments = fmt::format("{}", fmt::join(SimulateArgumentsOf(sequence), " "));
  return fmt::format("{}_{:08x}", fs::path(sequence.scenario).stem().string(),
                     std::hash<std::string>{}(arguments)&0xffffffff);
}

std::string FindFolder(const std::string& folder, const std::vector<fs::path>& roots) {
  std::error_code ignored;
  for (const fs::path& root : roots) {
    if (fs::is_directory(root / folder, ignored)) return (root / folder).string();
  }
  return "";
}

class Planner {
 public:
  Planner(const Suite& suite, const PlanOptions& options) : suite_(suite), options_(options) {}

  Plan Make() {
    for (const SuiteSequence& sequence : suite_.sequences) AddSequence(sequence);
    AddDetectors();
    std::stable_partition(plan_.tasks.begin(), plan_.tasks.end(),
                          [](const Task& task) { return !task.alone; });
    return std::move(plan_);
  }

 private:
  void AddSequence(const SuiteSequence& sequence) {
    std::string folder;
    if (sequence.scenario.empty()) {
      folder = FindFolder(sequence.folder, options_.roots);
    } else {
      folder = (options_.sequence_folder / RenderingName(sequence)).string();
      plan_.renderings.push_back({sequence.name, folder, SimulateArgumentsOf(sequence)});
    }
    if (folder.empty()) {
      plan_.missing.push_back({sequence.name, sequence.folder, sequence.address, ""});
      return;
    }
    plan_.folders.emplace_back(sequence.name, folder);
    for (const SuiteVariant& variant : suite_.variants) {
      const auto& only = variant.sequences;
      if (!only.empty() && std::find(only.begin(), only.end(), sequence.name) == only.end())
        continue;
      for (int repeat = 0; repeat < RepeatsOf(suite_, variant); ++repeat)
        plan_.tasks.push_back(MakeTask(sequence, folder, variant, repeat));
    }
  }

  Task MakeTask(const SuiteSequence& sequence, const std::string& folder,
                const SuiteVariant& variant, int repeat) const {
    Task task;
    task.id = fmt::format("{}/{}/{}", sequence.name, variant.name, repeat);
    task.sequence = sequence.name;
    task.variant = variant.name;
    task.repeat = repeat;
    task.alone = ModeOf(suite_, variant) == "realtime";
    task.program = variant.program;
    task.dataset = folder;
    task.arguments = RunArgumentsOf(suite_, sequence, variant, repeat);
    task.time_limit_s = TimeLimit(variant.time_limit_s);
    task.score_masks = suite_.score_masks && !task.alone && variant.dynamic != "off";
    // A configuration counts by what it says, not by where it is.
    std::vector<std::string> said = task.arguments;
    if (!variant.config.empty())
      std::replace(said.begin(), said.end(), variant.config, ReadText(variant.config));
    const std::string source =
        sequence.scenario.empty()
            ? sequence.folder
            : fmt::format("simulate {}", fmt::join(SimulateArgumentsOf(sequence), " "));
    task.fingerprint =
        fmt::format("{}; {}; {}{}; {}", source, fmt::join(said, " "), variant.program,
                    task.score_masks ? "; masks" : "", options_.build);
    return task;
  }

  void AddDetectors() {
    if (suite_.detectors.empty()) return;
    const DetectorData& data = suite_.detector_data;
    const std::string folder = FindFolder(data.folder, options_.roots);
    if (folder.empty()) {
      plan_.missing.push_back({"detector_data", data.folder, data.address, ""});
      return;
    }
    for (const SuiteDetector& detector : suite_.detectors) {
      Task task;
      task.id = "detectors/" + detector.name;
      task.variant = detector.name;
      task.is_detector = true;
      task.alone = true;
      task.dataset = folder;
      task.arguments = {"--model", detector.model, "--size", data.size};
      if (data.limit > 0) Append(task.arguments, {"--limit", std::to_string(data.limit)});
      task.time_limit_s = TimeLimit(0);
      task.fingerprint =
          fmt::format("{}; {}; {}", data.folder, fmt::join(task.arguments, " "), options_.build);
      plan_.tasks.push_back(std::move(task));
    }
  }

  double TimeLimit(double of_variant_s) const {
    if (options_.time_limit_s > 0) return options_.time_limit_s;
    return of_variant_s > 0 ? of_variant_s : suite_.time_limit_s;
  }

  const Suite& suite_;
  const PlanOptions& options_;
  Plan plan_;
};

nlohmann::json TaskToJson(const Task& task) {
  return {{"id", task.id},
          {"sequence", task.sequence},
          {"variant", task.variant},
          {"repeat", task.repeat},
          {"is_detector", task.is_detector},
          {"alone", task.alone},
          {"program", task.program},
          {"dataset", task.dataset},
          {"arguments", task.arguments},
          {"time_limit_s", task.time_limit_s},
          {"score_masks", task.score_masks},
          {"fingerprint", task.fingerprint}};
}

Task TaskFromJson(const nlohmann::json& json) {
  Task task;
  json.at("id").get_to(task.id);
  json.at("sequence").get_to(task.sequence);
  json.at("variant").get_to(task.variant);
  json.at("repeat").get_to(task.repeat);
  json.at("is_detector").get_to(task.is_detector);
  json.at("alone").get_to(task.alone);
  json.at("program").get_to(task.program);
  json.at("dataset").get_to(task.dataset);
  json.at("arguments").get_to(task.arguments);
  json.at("time_limit_s").get_to(task.time_limit_s);
  json.at("score_masks").get_to(task.score_masks);
  json.at("fingerprint").get_to(task.fingerprint);
  return task;
}

}  // namespace

const Task* Plan::Find(const std::string& id) const {
  const auto found =
      std::find_if(tasks.begin(), tasks.end(), [&](const Task& task) { return task.id == id; });
  return found == tasks.end() ? nullptr : &*found;
}

std::string Plan::FolderOf(const std::string& sequence) const {
  for (const auto& [name, folder] : folders) {
    if (name == sequence) return folder;
  }
  return "";
}

void Plan::Drop(const std::string& sequence, const std::string& reason) {
  std::erase_if(tasks, [&](const Task& task) { return task.sequence == sequence; });
  std::erase_if(folders, [&](const auto& folder) { return folder.first == sequence; });
  missing.push_back({sequence, "", "", reason});
}

Plan MakePlan(const Suite& suite, const PlanOptions& options) {
  return Planner(suite, options).Make();
}

std::vector<fs::path> RootsOfEnvironment() {
  std::vector<fs::path> roots;
  const char* text = std::getenv("MSF_SLAM_DATASETS");
  std::istringstream stream(text == nullptr ? "" : text);
  for (std::string root; std::getline(stream, root, ':');) {
    if (!root.empty()) roots.emplace_back(root);
  }
  return roots;
}

std::string DescribeMissing(const MissingSequence& missing) {
  if (!missing.reason.empty()) return missing.name + ": " + missing.reason;
  std::string where = "its suite names no address to get it from";
  if (!missing.address.empty())
    where = (missing.address.starts_with("http") ? "get it from " : "") + missing.address;
  return fmt::format("{}: the folder '{}' is in no root; {}", missing.name, missing.folder, where);
}

nlohmann::json PlanToJson(const Plan& plan) {
  nlohmann::json tasks = nlohmann::json::array();
  for (const Task& task : plan.tasks) tasks.push_back(TaskToJson(task));
  return {{"tasks", std::move(tasks)}};
}

StatusOr<Plan> ReadPlan(const fs::path& file) {
  Plan plan;
  try {
    std::ifstream stream(file);
    if (!stream) return Status::Error(file.string() + ": there is no such plan");
    const nlohmann::json json = nlohmann::json::parse(stream);
    for (const nlohmann::json& task : json.at("tasks")) plan.tasks.push_back(TaskFromJson(task));
  } catch (const nlohmann::json::exception& error) {
    return Status::Error(file.string() + ": is no plan: " + error.what());
  }
  return plan;
}

}  // namespace msf
