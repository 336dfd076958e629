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
    facts.about.push_back(
        fmt::format("{} tasks ran one by one, in real time; the times of the others are those of a "
                    "machine that may have done something else as well",
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

}  // namespace msf
