#include "bench/run_record.h"

#include <algorithm>
#include <fstream>
#include <map>

#include "bench/task_run.h"
#include "io/text_rows.h"

namespace msf {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMostVariants = 4;  // more curves in one picture cannot be told apart

// Cells of a line; the last one, a note that may hold commas, is not needed.
std::vector<std::string> Split(const std::string& line) {
  std::vector<std::string> cells;
  size_t start = 0;
  for (size_t comma = line.find(','); comma != std::string::npos;
       start = comma + 1, comma = line.find(',', start))
    cells.push_back(line.substr(start, comma - start));
  cells.push_back(line.substr(start));
  return cells;
}

class Columns {
 public:
  explicit Columns(const std::string& header) {
    const std::vector<std::string> names = Split(header);
    for (size_t i = 0; i < names.size(); ++i) place_[names[i]] = i;
  }

  std::string Text(const std::vector<std::string>& cells, const std::string& name) const {
    const auto at = place_.find(name);
    return at == place_.end() || at->second >= cells.size() ? "" : cells[at->second];
  }
  std::optional<double> Number(const std::vector<std::string>& cells,
                               const std::string& name) const {
    return ParseFiniteNumber(Text(cells, name));
  }
  // Share of points_static among all columns about points.
  std::optional<double> StaticShare(const std::vector<std::string>& cells) const {
    double all = 0;
    for (const auto& [name, place] : place_) {
      if (name.starts_with("points_")) all += Number(cells, name).value_or(0);
    }
    if (all == 0) return std::nullopt;
    return Number(cells, "points_static").value_or(0) / all;
  }

 private:
  std::map<std::string, size_t> place_;
};

const TaskResult* MedianRun(std::vector<const TaskResult*> runs) {
  std::erase_if(runs, [](const TaskResult* run) { return !run->ok() || !run->ate_m; });
  if (runs.empty()) return nullptr;
  const auto by_error = [](const TaskResult* a, const TaskResult* b) {
    return a->ate_m->rmse < b->ate_m->rmse;
  };
  std::sort(runs.begin(), runs.end(), by_error);
  return runs[(runs.size() - 1) / 2];
}

std::optional<RunRecord> LoadRun(const fs::path& out, const BenchResults& results,
                                 const SuiteSequence& sequence, const std::string& variant) {
  const TaskResult* run = MedianRun(results.Of(sequence.name, variant));
  const Task* task = run == nullptr ? nullptr : results.plan.Find(run->id);
  if (task == nullptr) return std::nullopt;
  const fs::path folder = TaskFolder(out, *task);
  StatusOr<std::vector<FrameRow>> frames = ReadFramesCsv(folder / "frames.csv");
  StatusOr<Trajectory> truth = ReadTrajectory(fs::path(task->dataset) / "groundtruth.txt");
  const StatusOr<Trajectory> estimate = ReadTrajectory(folder / "trajectory.txt");
  if (!frames.ok() || !truth.ok() || !estimate.ok()) return std::nullopt;
  StatusOr<Evaluation> evaluation =
      EvaluateTrajectory(variant, *truth, *estimate, {.num_input_frames = frames->size()});
  if (!evaluation.ok()) return std::nullopt;
  return RunRecord{variant, *std::move(frames), *std::move(truth), *std::move(evaluation)};
}

}  // namespace

StatusOr<std::vector<FrameRow>> ReadFramesCsv(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  if (!std::getline(stream, line)) return Status::Error(file.string() + ": cannot be read");
  const Columns columns(line);
  std::vector<FrameRow> frames;
  while (std::getline(stream, line)) {
    const std::vector<std::string> cells = Split(line);
    const std::optional<double> time_s = columns.Number(cells, "time_s");
    if (!time_s) return Status::Error(file.string() + ": a row has no time");
    frames.push_back({*time_s, columns.Text(cells, "state"), columns.Number(cells, "total_ms"),
                      columns.StaticShare(cells)});
  }
  return frames;
}

std::vector<RunRecord> LoadRuns(const fs::path& out, const BenchResults& results,
                                const SuiteSequence& sequence) {
  std::vector<RunRecord> records;
  const auto add = [&](const std::string& variant) {
    if (records.size() >= kMostVariants) return;
    if (std::optional<RunRecord> record = LoadRun(out, results, sequence, variant))
      records.push_back(*std::move(record));
  };
  add(results.suite.baseline);
  if (results.suite.ours != results.suite.baseline) add(results.suite.ours);
  if (!records.empty()) return records;
  for (const SuiteVariant& variant : results.suite.variants) add(variant.name);
  return records;
}

}  // namespace msf
