#include "bench/peers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "evaluation/evaluation.h"
#include "evaluation/statistics.h"
#include "io/trajectory_formats.h"
#include "io/tum_dataset.h"

namespace msf {
namespace {

namespace fs = std::filesystem;

bool IsNumber(const std::string& text) {
  return !text.empty() && std::all_of(text.begin(), text.end(),
                                      [](unsigned char c) { return std::isdigit(c) != 0; });
}

// Whether a file's stem means `name`: itself, or with the number of a run behind it.
bool Means(const std::string& stem, const std::string& name) {
  if (name.empty() || !stem.starts_with(name)) return false;
  const std::string rest = stem.substr(name.size());
  return rest.empty() || ((rest[0] == '_' || rest[0] == '.') && IsNumber(rest.substr(1)));
}

std::vector<fs::path> FilesOf(const Peer& peer, const SuiteSequence& sequence) {
  std::vector<fs::path> files;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(peer.folder, none)) {
    const std::string stem = entry.path().stem().string();
    if (Means(stem, sequence.name) || Means(stem, sequence.folder)) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::optional<ErrorFigures> FiguresOf(const std::vector<double>& values, double unit = 1) {
  if (values.empty()) return std::nullopt;
  const Statistics s = ComputeStatistics(values);
  return ErrorFigures{s.rmse / unit, s.std / unit, s.mean / unit, s.median / unit, s.max / unit};
}

Status Evaluate(const fs::path& file, const std::string& dataset_folder, TaskResult& result) {
  // What the camera is does not matter here; any preset opens the lists.
  const StatusOr<TumDataset> dataset = TumDataset::Open(dataset_folder, "tum_fr3");
  if (!dataset.ok()) return dataset.status();
  const std::optional<fs::path> truth_file = dataset->ground_truth_file();
  if (!truth_file) return Status::Error(dataset_folder + ": has no groundtruth.txt");
  std::vector<double> times_s;
  for (size_t i = 0; i < dataset->size(); ++i) times_s.push_back(dataset->time_s(i));
  const StatusOr<Trajectory> truth = ReadTrajectory(*truth_file);
  if (!truth.ok()) return truth.status();
  const StatusOr<Trajectory> estimate = ReadForeignTrajectory(file, times_s);
  if (!estimate.ok()) return estimate.status();
  const StatusOr<Evaluation> evaluation =
      EvaluateTrajectory(result.variant, *truth, *estimate, {.num_input_frames = times_s.size()});
  if (!evaluation.ok()) return evaluation.status();
  constexpr double kDegree = 3.14159265358979323846 / 180;
  result.num_frames = times_s.size();
  result.coverage = evaluation->Coverage();
  result.ate_m = FiguresOf(evaluation->absolute.translation_m.value);
  result.rpe_frame_m = FiguresOf(evaluation->per_frame.translation_m.value);
  result.rpe_frame_deg = FiguresOf(evaluation->per_frame.rotation_rad.value, kDegree);
  result.rpe_second_m = FiguresOf(evaluation->per_second.translation_m.value);
  return Status::Ok();
}

}  // namespace

StatusOr<Peer> ParsePeer(const std::string& text) {
  const size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    return Status::Error("'" + text + "' is not of the form NAME=FOLDER");
  Peer peer{text.substr(0, equals), text.substr(equals + 1)};
  std::error_code ignored;
  if (!fs::is_directory(peer.folder, ignored))
    return Status::Error(peer.folder.string() + ": there is no such folder of trajectories");
  return peer;
}

Status AddPeer(const Peer& peer, BenchResults& results) {
  if (results.suite.FindVariant(peer.name) != nullptr)
    return Status::Error("'" + peer.name + "' is a variant of the suite; call the peer otherwise");
  size_t num_files = 0;
  for (const SuiteSequence& sequence : results.suite.sequences) {
    const std::string folder = results.plan.FolderOf(sequence.name);
    if (folder.empty()) continue;
    int repeat = 0;
    for (const fs::path& file : FilesOf(peer, sequence)) {
      TaskResult result;
      result.id = fmt::format("{}/{}/{}", sequence.name, peer.name, repeat);
      result.sequence = sequence.name;
      result.variant = peer.name;
      result.repeat = repeat++;
      result.fingerprint = "peer " + file.filename().string();
      const Status status = Evaluate(file, folder, result);
      result.status = status.ok() ? "ok" : "failed";
      result.reason = status.message();
      results.results.push_back(std::move(result));
      ++num_files;
    }
  }
  results.peers.push_back(peer.name);
  if (num_files == 0) {
    results.peer_notes.push_back(
        fmt::format("{}: no file in {} is named after a sequence that is here", peer.name,
                    peer.folder.filename().string()));
  }
  return Status::Ok();
}

}  // namespace msf
