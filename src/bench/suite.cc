#include "bench/suite.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <set>
#include <tuple>

#include "util/data_path.h"
#include "util/options.h"

namespace msf {
namespace {

namespace fs = std::filesystem;

// Names become folders.
Status CheckName(const std::string& what, const std::string& name) {
  const auto allowed = [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.' || c == '+';
  };
  if (!name.empty() && name.front() != '.' && std::all_of(name.begin(), name.end(), allowed))
    return Status::Ok();
  return Status::Error(fmt::format(
      "'{}' is no name for a {}: use letters, digits, '_', '-', '+' and '.'", name, what));
}

Status CheckMode(const std::string& mode) {
  if (mode == "deterministic" || mode == "threaded" || mode == "realtime") return Status::Ok();
  return Status::Error("'" + mode + "' is no mode: use deterministic, threaded or realtime");
}

template <typename Entry>
Status CheckNames(const std::string& what, const std::vector<Entry>& entries) {
  std::set<std::string> names;
  for (const Entry& entry : entries) {
    MSF_RETURN_IF_ERROR(CheckName(what, entry.name));
    if (!names.insert(entry.name).second)
      return Status::Error(fmt::format("there are two {}s '{}'", what, entry.name));
  }
  return Status::Ok();
}

Status CheckSequence(const Suite& suite, const SuiteSequence& sequence) {
  if (sequence.folder.empty() == sequence.scenario.empty()) {
    return Status::Error(fmt::format(
        "sequence '{}' needs either a folder (recorded) or a scenario (simulated)", sequence.name));
  }
  if (sequence.frames < 0)
    return Status::Error(fmt::format("sequence '{}': frames cannot be negative", sequence.name));
  if (!sequence.calm.empty() && suite.FindSequence(sequence.calm) == nullptr) {
    return Status::Error(fmt::format("sequence '{}': calm names '{}', which is no sequence here",
                                     sequence.name, sequence.calm));
  }
  return Status::Ok();
}

Status CheckVariant(const Suite& suite, const SuiteVariant& variant) {
  const auto problem = [&](const std::string& what) {
    return Status::Error(fmt::format("variant '{}': {}", variant.name, what));
  };
  if (!variant.mode.empty()) {
    if (const Status mode = CheckMode(variant.mode); !mode.ok()) return problem(mode.message());
  }
  if (variant.repeats < 0 || !(variant.time_limit_s >= 0) || !(variant.threshold_px >= 0))
    return problem("repeats, time_limit_s and threshold_px cannot be negative");
  if (variant.threshold_px > 0 && variant.dynamic != "paper" && variant.dynamic != "full")
    return problem("threshold_px belongs to dynamic: paper or full");
  for (const std::string& name : variant.sequences) {
    if (suite.FindSequence(name) == nullptr)
      return problem("sequence '" + name + "' is not in the suite");
  }
  return Status::Ok();
}

// The variants that stand in the paper's columns, where somebody chose them.
Status CheckColumns(const Suite& suite) {
  const Suite defaults;
  for (const auto& [key, name, usual] : {std::tuple("baseline", suite.baseline, defaults.baseline),
                                         std::tuple("ours", suite.ours, defaults.ours)}) {
    if (name != usual && suite.FindVariant(name) == nullptr)
      return Status::Error(fmt::format("{} names '{}', which is no variant here", key, name));
  }
  return Status::Ok();
}

template <typename Entry>
const Entry* Find(const std::vector<Entry>& entries, const std::string& name) {
  const auto found = std::find_if(entries.begin(), entries.end(),
                                  [&](const Entry& entry) { return entry.name == name; });
  return found == entries.end() ? nullptr : &*found;
}

template <typename Entry>
Status Keep(const std::string& what, const std::vector<std::string>& names,
            std::vector<Entry>& entries) {
  for (const std::string& name : names) {
    if (Find(entries, name) != nullptr) continue;
    std::vector<std::string> known;
    known.reserve(entries.size());
    for (const Entry& entry : entries) known.push_back(entry.name);
    return Status::Error(
        fmt::format("the suite has no {} '{}', only: {}", what, name, fmt::join(known, ", ")));
  }
  if (names.empty()) return Status::Ok();
  std::erase_if(entries, [&](const Entry& entry) {
    return std::find(names.begin(), names.end(), entry.name) == names.end();
  });
  return Status::Ok();
}

StatusOr<fs::path> FindSuite(const std::string& name_or_file) {
  std::error_code ignored;
  const fs::path file(name_or_file);
  if (fs::is_regular_file(file, ignored)) return file;
  if (file.extension() == ".yaml" || file.has_parent_path())
    return Status::Error(name_or_file + ": there is no such file");
  StatusOr<fs::path> shipped = FindDataFile("suites/" + name_or_file + ".yaml");
  if (shipped.ok()) return shipped;
  return Status::Error(
      fmt::format("there is no suite '{}', neither as a file nor among those that "
                  "ship: {}",
                  name_or_file, fmt::join(SuiteNames(), ", ")));
}

}  // namespace

const SuiteSequence* Suite::FindSequence(const std::string& sequence) const {
  return Find(sequences, sequence);
}

const SuiteVariant* Suite::FindVariant(const std::string& variant) const {
  return Find(variants, variant);
}

Status Suite::Check() const {
  MSF_RETURN_IF_ERROR(CheckMode(mode));
  if (repeats < 1) return Status::Error("repeats must be at least 1");
  if (!(time_limit_s > 0)) return Status::Error("time_limit_s must be positive");
  if (max_frames < 0) return Status::Error("max_frames cannot be negative");
  if (detectors.empty() && (sequences.empty() || variants.empty()))
    return Status::Error("a suite needs sequences and variants, or detectors");
  if (!detectors.empty() && detector_data.folder.empty())
    return Status::Error("detectors need detector_data.folder, images in PASCAL VOC layout");
  MSF_RETURN_IF_ERROR(CheckNames("sequence", sequences));
  MSF_RETURN_IF_ERROR(CheckNames("variant", variants));
  MSF_RETURN_IF_ERROR(CheckNames("detector", detectors));
  for (const SuiteSequence& sequence : sequences)
    MSF_RETURN_IF_ERROR(CheckSequence(*this, sequence));
  for (const SuiteVariant& variant : variants) MSF_RETURN_IF_ERROR(CheckVariant(*this, variant));
  return CheckColumns(*this);
}

Status Suite::KeepOnly(const std::vector<std::string>& sequence_names,
                       const std::vector<std::string>& variant_names) {
  MSF_RETURN_IF_ERROR(Keep("sequence", sequence_names, sequences));
  return Keep("variant", variant_names, variants);
}

std::string ModeOf(const Suite& suite, const SuiteVariant& variant) {
  return variant.mode.empty() ? suite.mode : variant.mode;
}

int RepeatsOf(const Suite& suite, const SuiteVariant& variant) {
  return variant.repeats > 0 ? variant.repeats : suite.repeats;
}

StatusOr<Suite> LoadSuite(const std::string& name_or_file) {
  StatusOr<fs::path> file = FindSuite(name_or_file);
  if (!file.ok()) return file.status();
  Suite suite;
  MSF_RETURN_IF_ERROR(LoadOptions(*file, suite));
  if (suite.name.empty()) suite.name = file->stem().string();
  const Status sense = suite.Check();
  if (!sense.ok()) return Status::Error(file->string() + ": " + sense.message());
  for (SuiteVariant& variant : suite.variants) {
    if (!variant.config.empty() && fs::path(variant.config).is_relative())
      variant.config = fs::absolute(file->parent_path() / variant.config).lexically_normal();
  }
  return suite;
}

std::vector<std::string> SuiteNames() {
  std::set<std::string> names;
  for (const fs::path& folder : DataFolders()) {
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(folder / "suites", none)) {
      if (entry.path().extension() == ".yaml") names.insert(entry.path().stem().string());
    }
  }
  return {names.begin(), names.end()};
}

}  // namespace msf
