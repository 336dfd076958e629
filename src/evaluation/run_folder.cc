#include "evaluation/run_folder.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <system_error>

#include "evaluation/dynamics_summary.h"
#include "evaluation/trajectory_plot.h"
#include "util/atomic_file.h"

namespace msf {
namespace {

// As CSV wants it: quoted, with inner quotes doubled.
std::string Quoted(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c == '\n' ? ' ' : c;
  }
  return quoted + '"';
}

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
  return row + "," + (frame.note.empty() ? "" : Quoted(frame.note)) + "\n";
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

Status PrepareRunFolder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!error && !std::filesystem::is_directory(folder, error))
    error = std::make_error_code(std::errc::not_a_directory);
  if (!error && access(folder.c_str(), W_OK | X_OK) != 0) error = {errno, std::generic_category()};
  if (!error) return Status::Ok();
  return Status::Error(
      fmt::format("{}: the results cannot be written there ({}); name another folder",
                  folder.string(), error.message()));
}

Status WriteRunFolder(const std::filesystem::path& folder, const RunResults& results,
                      const RunReport& report) {
  MSF_RETURN_IF_ERROR(PrepareRunFolder(folder));
  std::string problems;
  const auto note = [&problems](const Status& status) {
    if (!status.ok()) problems += (problems.empty() ? "" : "\n") + status.message();
  };
  note(WriteTrajectory(folder / "trajectory.txt", FrameTrajectory(results)));
  note(WriteTrajectory(folder / "keyframes.txt", results.keyframes));
  note(WriteFileAtomically(folder / "frames.csv", FormatFramesCsv(results.frames)));
  note(WritePly(folder / "map.ply", results.points));
  note(WriteFileAtomically(folder / "config.yaml", results.config_yaml));
  note(WriteFileAtomically(folder / "report.json", RunReportToJson(report).dump(2) + "\n"));
  if (report.evaluation) {
    const std::span<const Evaluation> evaluation(&*report.evaluation, 1);
    note(WriteFileAtomically(folder / "trajectory.svg",
                             PlotTrajectories(*results.ground_truth, evaluation)));
    note(WriteFileAtomically(folder / "error.svg", PlotErrors(evaluation)));
  } else {
    std::error_code ignored;
    for (const char* name : {"trajectory.svg", "error.svg"})
      std::filesystem::remove(folder / name, ignored);
  }
  return problems.empty() ? Status::Ok() : Status::Error(problems);
}

}  // namespace msf
