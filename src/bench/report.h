// The report of a bench: for reading (HTML, markdown) and for other programs (CSV).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/bench_run.h"
#include "bench/figures.h"
#include "bench/published.h"
#include "bench/table.h"
#include "util/status.h"

namespace msf {

// What both forms of the report say before the tables, one sentence each.
struct ReportFacts {
  std::vector<std::string> about;     // program, machine, how often and in which mode
  std::vector<std::string> missing;   // sequences that are not there, and where they can be had
  std::vector<std::string> problems;  // tasks that did not succeed, and why
};
ReportFacts GatherFacts(const BenchResults& results);
// Which tables of the paper are not among these, and the suites that have them; empty for none.
std::string DescribeAbsentTables(const std::vector<Table>& tables);

std::string MarkdownReport(const BenchResults& results, const std::vector<Table>& tables,
                           const std::vector<Figure>& figures);
// One file without anything outside it: pictures are in it.
std::string HtmlReport(const BenchResults& results, const std::vector<Table>& tables,
                       const std::vector<Figure>& figures);

// Writes report.html, report.md, tables/*.csv and figures/*.svg into `out`.
Status WriteReport(const std::filesystem::path& out, const BenchResults& results);

}  // namespace msf
