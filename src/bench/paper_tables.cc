#include "bench/paper_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "bench/table_cells.h"

namespace msf {
namespace {

using ErrorMember = std::optional<ErrorFigures> TaskResult::*;

constexpr char kMarks[] =
    "In italics: as published, not measured by us. Ours are medians over the repeats; coverage is "
    "the lowest of them.";

Cell Published(const std::string& text) { return {text, true}; }

const PublishedError* Find(const std::vector<PublishedError>& errors, const std::string& sequence,
                           const std::string& system) {
  const auto found = std::find_if(errors.begin(), errors.end(), [&](const PublishedError& e) {
    return e.sequence == sequence && e.system == system;
  });
  return found == errors.end() ? nullptr : &*found;
}

// Values of `key` in the order of their first appearance.
std::vector<std::string> Distinct(const std::vector<PublishedError>& errors,
                                  std::string PublishedError::*key) {
  std::vector<std::string> values;
  for (const PublishedError& e : errors) {
    if (std::find(values.begin(), values.end(), e.*key) == values.end()) values.push_back(e.*key);
  }
  return values;
}

// RMSE, STD, mean, median, range, coverage.
void AddMeasured(const std::vector<const TaskResult*>& runs, ErrorMember error,
                 std::vector<Cell>& row) {
  for (double ErrorFigures::*figure :
       {&ErrorFigures::rmse, &ErrorFigures::std, &ErrorFigures::mean, &ErrorFigures::median})
    row.emplace_back(FormatMedian(SpreadOf(runs, FigureOf(error, figure)), 4));
  row.emplace_back(FormatRange(SpreadOf(runs, FigureOf(error, &ErrorFigures::rmse)), 4));
  row.emplace_back(FormatCoverage(runs));
}

void AddPublished(const PublishedError* e, std::vector<Cell>& row) {
  for (double PublishedError::*figure : {&PublishedError::rmse, &PublishedError::std,
                                         &PublishedError::mean, &PublishedError::median})
    row.push_back(e == nullptr ? Cell() : PublishedNumber(e->*figure, 4));
  row.insert(row.end(), {Cell(), Cell()});
}

std::vector<Cell> PublishedRow(const std::string& sequence,
                               const std::vector<PublishedError>& errors) {
  std::vector<Cell> row = {Published(sequence), Published("published")};
  AddPublished(Find(errors, sequence, "ORB-SLAM3"), row);
  AddPublished(Find(errors, sequence, "MSF-SLAM"), row);
  return row;
}

// The rows of tables 5 and 6: under each sequence of the paper ours, then those that only we have.
Table ErrorTable(const BenchResults& results, const std::vector<PublishedError>& errors,
                 ErrorMember error) {
  const Suite& suite = results.suite;
  Table table;
  table.num_label_columns = 2;
  table.note = kMarks;
  table.groups = {
      {"", 2}, {"ORB-SLAM3 / our " + suite.baseline, 6}, {"MSF-SLAM / our " + suite.ours, 6}};
  table.columns = {"Sequence", "Source"};
  for (int i = 0; i < 2; ++i) {
    for (const char* column : {"RMSE", "STD", "Mean", "Median", "min-max", "Coverage"})
      table.columns.emplace_back(column);
  }
  const auto add_ours = [&](const SuiteSequence& sequence) {
    const auto baseline = results.Of(sequence.name, suite.baseline),
               ours = results.Of(sequence.name, suite.ours);
    if (baseline.empty() && ours.empty()) return;
    std::vector<Cell> row = {sequence.name, "measured"};
    AddMeasured(baseline, error, row);
    AddMeasured(ours, error, row);
    table.rows.push_back(std::move(row));
  };
  const std::vector<std::string> known = Distinct(errors, &PublishedError::sequence);
  for (const std::string& name : known) {
    table.rows.push_back(PublishedRow(name, errors));
    for (const SuiteSequence& sequence : suite.sequences) {
      if (sequence.published_as == name) add_ours(sequence);
    }
  }
  for (const SuiteSequence& sequence : suite.sequences) {
    if (std::find(known.begin(), known.end(), sequence.published_as) == known.end())
      add_ours(sequence);
  }
  return table;
}

std::string RmseAndStd(const std::vector<const TaskResult*>& runs) {
  const auto rmse = SpreadOf(runs, FigureOf(&TaskResult::ate_m, &ErrorFigures::rmse));
  if (!rmse) return "";
  const auto std = SpreadOf(runs, FigureOf(&TaskResult::ate_m, &ErrorFigures::std));
  return fmt::format("{}/{} ({})", FormatMedian(rmse, 4), FormatMedian(std, 4),
                     FormatCoverage(runs));
}

// One column per system of the literature, ours, one per peer.
Table ComparedTable(const BenchResults& results, const std::vector<PublishedError>& errors) {
  const std::vector<std::string> systems = Distinct(errors, &PublishedError::system);
  std::vector<std::string> measured = {results.suite.ours};
  measured.insert(measured.end(), results.peers.begin(), results.peers.end());
  Table table{"table7",
              "Table 7: ATE against other systems, RMSE/STD in m",
              std::string(kMarks) + " Ours and the peers: RMSE/STD (coverage).",
              {{"", 1},
               {"published", static_cast<int>(systems.size())},
               {"measured", static_cast<int>(measured.size())}},
              {"Sequence"},
              {}};
  table.columns.insert(table.columns.end(), systems.begin(), systems.end());
  for (const std::string& name : measured)
    table.columns.push_back(name == results.suite.ours ? "our " + name : name);
  const auto add = [&](const std::string& name, const std::string& published,
                       const std::string& sequence) {
    std::vector<Cell> row = {Cell(name, sequence.empty())};
    for (const std::string& system : systems) {
      const PublishedError* e = Find(errors, published, system);
      row.push_back(e == nullptr ? Cell()
                                 : Published(fmt::format("{:.4f}/{:.4f}", e->rmse, e->std)));
    }
    for (const std::string& system : measured)
      row.emplace_back(RmseAndStd(results.Of(sequence, system)));
    table.rows.push_back(std::move(row));
  };
  std::set<std::string> shown;
  for (const SuiteSequence& sequence : results.suite.sequences) {
    shown.insert(sequence.published_as);
    add(sequence.name, sequence.published_as, sequence.name);
  }
  for (const std::string& name : Distinct(errors, &PublishedError::sequence)) {
    if (!shown.contains(name)) add(name, name, "");
  }
  return table;
}

// One row per system, one column per sequence; only sequences that the suite has.
Table OthersTable(const BenchResults& results, const std::vector<PublishedError>& errors) {
  Table table{
      "table7_others", "ATE published by further systems, RMSE in m", kMarks, {}, {"System"}, {}};
  std::vector<const SuiteSequence*> sequences;
  for (const SuiteSequence& sequence : results.suite.sequences) {
    const auto is_it = [&](const PublishedError& e) { return e.sequence == sequence.published_as; };
    if (std::none_of(errors.begin(), errors.end(), is_it)) continue;
    sequences.push_back(&sequence);
    table.columns.push_back(sequence.name);
  }
  for (const std::string& system : Distinct(errors, &PublishedError::system)) {
    std::vector<Cell> row = {Published(system)};
    bool any = false;
    for (const SuiteSequence* sequence : sequences) {
      const PublishedError* e = Find(errors, sequence->published_as, system);
      any = any || e != nullptr;
      row.push_back(e == nullptr ? Cell() : PublishedNumber(e->rmse, 4));
    }
    if (any) table.rows.push_back(std::move(row));
  }
  std::vector<std::string> measured = {results.suite.baseline, results.suite.ours};
  measured.insert(measured.end(), results.peers.begin(), results.peers.end());
  for (const std::string& variant : measured) {
    std::vector<Cell> row = {variant + " (measured)"};
    for (const SuiteSequence* sequence : sequences) {
      const auto runs = results.Of(sequence->name, variant);
      const auto rmse = SpreadOf(runs, FigureOf(&TaskResult::ate_m, &ErrorFigures::rmse));
      row.emplace_back(rmse ? fmt::format("{} ({})", FormatMedian(rmse, 4), FormatCoverage(runs))
                            : "");
    }
    table.rows.push_back(std::move(row));
  }
  if (sequences.empty()) table.rows.clear();
  return table;
}

}  // namespace

Table AbsoluteErrorTable(const BenchResults& results, const PublishedFigures& published) {
  Table table = ErrorTable(results, published.ate, &TaskResult::ate_m);
  table.id = "table5";
  table.title = "Table 5: absolute trajectory error (ATE), m";
  return table;
}

Table RelativeErrorTable(const BenchResults& results, const PublishedFigures& published) {
  Table table = ErrorTable(results, published.rpe, &TaskResult::rpe_frame_m);
  table.id = "table6";
  table.title = "Table 6: relative pose error (RPE) of one frame, translation, m";
  return table;
}

std::vector<Table> ComparisonTables(const BenchResults& results,
                                    const PublishedFigures& published) {
  std::vector<Table> tables = {ComparedTable(results, published.compared)};
  Table others = OthersTable(results, published.others);
  if (!others.rows.empty()) tables.push_back(std::move(others));
  return tables;
}

std::vector<Table> PaperTables(const BenchResults& results, const PublishedFigures& published) {
  std::vector<Table> tables = ThresholdTables(results, published);
  const auto add = [&tables](std::vector<Table> more) {
    std::move(more.begin(), more.end(), std::back_inserter(tables));
  };
  add(DetectorTables(results, published));
  if (results.suite.sequences.empty()) return tables;
  tables.push_back(AbsoluteErrorTable(results, published));
  tables.push_back(RelativeErrorTable(results, published));
  add(ComparisonTables(results, published));
  tables.push_back(RuntimeTable(results, published));
  return tables;
}

}  // namespace msf
