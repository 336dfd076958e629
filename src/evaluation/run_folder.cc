#include "evaluation/run_folder.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <exception>
#include <functional>
#include <set>
#include <span>
#include <system_error>

#include "evaluation/dynamics_summary.h"
#include "evaluation/json_text.h"
#include "evaluation/label_files.h"
#include "evaluation/trajectory_plot.h"
#include "util/atomic_file.h"

namespace msf {
namespace {

namespace fs = std::filesystem;

std::string CsvRow(size_t index, const FrameRecord& frame, const std::set<std::string>& stages,
                   bool with_dynamics) {
  std::string row = fmt::format("{},{:.6f},{},{},{},", index, frame.time_s, frame.state,
                                frame.T_wc ? 1 : 0, frame.num_inliers);
  if (frame.keyframe_id >= 0) row += std::to_string(frame.keyframe_id);
  if (with_dynamics) row += DynamicsCsvCells(frame.dynamics ? &*frame.dynamics : nullptr);
  for (const std::string& stage : stages) {
    const auto ms = frame.timings_ms.find(stage);
    row += ms == frame.timings_ms.end() ? "," : fmt::format(",{:.3f}", ms->second);
  }
  return row + "," + (frame.note.empty() ? "" : QuotedForCsv(frame.note)) + "\n";
}

// A file that cannot even be composed must not cost a run the others.
Status TryToWrite(const fs::path& file, const std::function<Status(const fs::path&)>& to) {
  try {
    return to(file);
  } catch (const std::exception& error) {
    return Status::Error(file.string() + ": cannot be written: " + error.what());
  }
}

}  // namespace

std::string FormatFramesCsv(const std::vector<FrameRecord>& frames) {
  std::set<std::string> stages;
  for (const FrameRecord& frame : frames) {
    for (const auto& [stage, ms] : frame.timings_ms) stages.insert(stage);
  }
  const bool with_dynamics =
      std::any_of(frames.begin(), frames.end(),
                  [](const FrameRecord& frame) { return frame.dynamics.has_value(); });
  std::string csv = "frame,time_s,state,pose,inliers,keyframe_id";
  if (with_dynamics) csv += DynamicsCsvHeader();
  for (const std::string& stage : stages) csv += "," + stage + "_ms";
  csv += ",note\n";
  for (size_t i = 0; i < frames.size(); ++i) csv += CsvRow(i, frames[i], stages, with_dynamics);
  return csv;
}

Status PrepareRunFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!error && !fs::is_directory(folder, error))
    error = std::make_error_code(std::errc::not_a_directory);
  if (!error && access(folder.c_str(), W_OK | X_OK) != 0) error = {errno, std::generic_category()};
  if (!error) return Status::Ok();
  return Status::Error(
      fmt::format("{}: the results cannot be written there ({}); name another folder",
                  folder.string(), error.message()));
}

Status WriteRunFolder(const fs::path& folder, const RunResults& results, const RunReport& report) {
  MSF_RETURN_IF_ERROR(PrepareRunFolder(folder));
  std::string problems;
  const auto write = [&](const char* name, const std::function<Status(const fs::path&)>& to) {
    const Status status = TryToWrite(folder / name, to);
    if (!status.ok()) problems += (problems.empty() ? "" : "\n") + status.message();
  };
  const auto write_text = [&](const char* name, const std::function<std::string()>& text) {
    write(name, [&](const fs::path& file) { return WriteFileAtomically(file, text()); });
  };
  write("trajectory.txt",
        [&](const fs::path& file) { return WriteTrajectory(file, FrameTrajectory(results)); });
  write("keyframes.txt",
        [&](const fs::path& file) { return WriteTrajectory(file, results.keyframes); });
  write_text("frames.csv", [&] { return FormatFramesCsv(results.frames); });
  write("map.ply", [&](const fs::path& file) { return WritePly(file, results.points); });
  write_text("config.yaml", [&] { return results.config_yaml; });
  write_text("camera.yaml", [&] { return results.camera_yaml; });
  write_text("report.json", [&] { return JsonText(RunReportToJson(report)); });
  if (report.evaluation) {
    const std::span<const Evaluation> evaluation(&*report.evaluation, 1);
    write_text("trajectory.svg",
               [&] { return PlotTrajectories(*results.ground_truth, evaluation); });
    write_text("error.svg", [&] { return PlotErrors(evaluation); });
  } else {
    std::error_code ignored;
    for (const char* name : {"trajectory.svg", "error.svg"}) fs::remove(folder / name, ignored);
  }
  return problems.empty() ? Status::Ok() : Status::Error(problems);
}

}  // namespace msf
