// A suite written out: every single run, and what has to be there before it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "bench/suite.h"
#include "util/status.h"

namespace msf {

// One run of one variant on one sequence.
struct Task {
  std::string id;  // SEQUENCE/VARIANT/REPEAT, or detectors/NAME; its folder below tasks/
  std::string sequence;
  std::string variant;
  int repeat = 0;
  bool is_detector = false;  // scores a detector on labelled images instead
  bool alone = false;        // its times count: nothing else runs beside it
  std::string program;       // empty: this one
  std::string dataset;
  std::vector<std::string> arguments;  // of `msf-slam run` or `msf-slam detector evaluate`
  double time_limit_s = 0;
  bool score_masks = false;
  // What decides the result, as text without places on this machine: a result with another one is
  // out of date.
  std::string fingerprint;
};

// A sequence that the simulator makes.
struct Rendering {
  std::string sequence;
  std::string folder;
  std::vector<std::string> arguments;  // of `msf-slam simulate`, without --out
};

// A sequence that cannot be run on.
struct MissingSequence {
  std::string name;
  std::string folder;   // recorded: what was looked for
  std::string address;  // recorded: where it can be had
  std::string reason;   // simulated: why it could not be rendered
};

struct Plan {
  std::vector<Task> tasks;  // those that run alone come last
  std::vector<Rendering> renderings;
  std::vector<MissingSequence> missing;
  // Folder of every sequence that is there or will be.
  std::vector<std::pair<std::string, std::string>> folders;

  const Task* Find(const std::string& id) const;
  // Empty when the sequence is missing.
  std::string FolderOf(const std::string& sequence) const;
  // Takes out a sequence that turned out not to be there.
  void Drop(const std::string& sequence, const std::string& reason);
};

struct PlanOptions {
  std::vector<std::filesystem::path> roots;  // where recorded data sets may be
  std::filesystem::path sequence_folder;     // where simulated ones are made and kept
  std::string build;                         // of the program, for the fingerprints
  double time_limit_s = 0;                   // replaces those of the suite; 0: no
};

Plan MakePlan(const Suite& suite, const PlanOptions& options);

// The folders named by the environment variable MSF_SLAM_DATASETS, separated by ':'.
std::vector<std::filesystem::path> RootsOfEnvironment();

// A sentence about each sequence that is not there, with its address.
std::string DescribeMissing(const MissingSequence& missing);

// plan.json: what a process that does a single task has to know.
nlohmann::json PlanToJson(const Plan& plan);
StatusOr<Plan> ReadPlan(const std::filesystem::path& file);

}  // namespace msf
