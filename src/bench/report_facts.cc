#include <fmt/format.h>

#include <algorithm>

#include "bench/report.h"

namespace msf {

ReportFacts GatherFacts(const BenchResults& results) {
  ReportFacts facts;
  const Suite& suite = results.suite;
  if (!suite.description.empty()) facts.about.push_back(suite.description);
  facts.about.push_back("Program: " + results.build.ToString());
  facts.about.push_back("Machine: " + results.machine.ToString());
  const auto num_ok = std::count_if(results.results.begin(), results.results.end(),
                                    [](const TaskResult& result) { return result.ok(); });
  facts.about.push_back(fmt::format("{} of {} tasks succeeded", num_ok, results.results.size()));
  const auto alone = std::count_if(results.plan.tasks.begin(), results.plan.tasks.end(),
                                   [](const Task& task) { return task.alone; });
  if (alone > 0) {
    facts.about.push_back(fmt::format(
        "{} tasks ran one by one because their times count; the times of the others are "
        "those of a machine that did something else as well",
        alone));
  }
  for (const MissingSequence& missing : results.plan.missing)
    facts.missing.push_back(DescribeMissing(missing));
  for (const TaskResult& result : results.results) {
    if (!result.ok())
      facts.problems.push_back(fmt::format("{}: {}: {}", result.id, result.status, result.reason));
  }
  facts.problems.insert(facts.problems.end(), results.peer_notes.begin(), results.peer_notes.end());
  return facts;
}

std::string DescribeAbsentTables(const std::vector<Table>& tables) {
  struct Source {
    const char* id;  // how those of the table begin
    const char* text;
  };
  constexpr Source kSources[] = {{"table1_", "table 1 (suite threshold)"},
                                 {"table3", "tables 3 and 4 (suite detector)"},
                                 {"table5", "tables 5 to 7 (suite tum_dynamic)"},
                                 {"table8", "table 8 (suite runtime)"}};
  std::string text;
  for (const Source& source : kSources) {
    const auto is_it = [&](const Table& table) { return table.id.starts_with(source.id); };
    if (std::any_of(tables.begin(), tables.end(), is_it)) continue;
    text += std::string(text.empty() ? "Not in this suite: " : ", ") + source.text;
  }
  return text.empty() ? "" : text + ". Table 2 of the paper is an algorithm.";
}

}  // namespace msf
