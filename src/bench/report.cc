#include "bench/report.h"

#include <iterator>
#include <system_error>

#include "bench/paper_tables.h"
#include "util/atomic_file.h"

namespace msf {
namespace {

namespace fs = std::filesystem;

// A fresh folder: nothing of an earlier report stays.
Status MakeFolder(const fs::path& folder) {
  std::error_code error;
  fs::remove_all(folder, error);
  fs::create_directories(folder, error);
  if (!error) return Status::Ok();
  return Status::Error(folder.string() + ": cannot be made: " + error.message());
}

std::vector<Figure> AllFigures(const fs::path& out, const BenchResults& results) {
  std::vector<Figure> figures = DetectionFigures(out, results);
  for (auto* more : {&TrajectoryFigures, &SequenceFigures}) {
    std::vector<Figure> added = more(out, results);
    std::move(added.begin(), added.end(), std::back_inserter(figures));
  }
  return figures;
}

}  // namespace

Status WriteReport(const fs::path& out, const BenchResults& results) {
  const StatusOr<PublishedFigures> published = LoadPublishedFigures();
  if (!published.ok()) return published.status();
  std::vector<Table> tables;
  if (!results.suite.sequences.empty()) tables.push_back(OverviewTable(results));
  for (Table& table : PaperTables(results, *published)) tables.push_back(std::move(table));
  if (!results.suite.sequences.empty()) tables.push_back(VariantTable(results));
  MSF_RETURN_IF_ERROR(MakeFolder(out / "tables"));
  for (const Table& table : tables)
    MSF_RETURN_IF_ERROR(
        WriteFileAtomically(out / "tables" / (table.id + ".csv"), TableToCsv(table)));
  MSF_RETURN_IF_ERROR(MakeFolder(out / "figures"));
  const std::vector<Figure> figures = AllFigures(out, results);
  for (const Figure& figure : figures)
    MSF_RETURN_IF_ERROR(WriteFileAtomically(out / "figures" / (figure.id + ".svg"), figure.svg));
  MSF_RETURN_IF_ERROR(
      WriteFileAtomically(out / "report.md", MarkdownReport(results, tables, figures)));
  return WriteFileAtomically(out / "report.html", HtmlReport(results, tables, figures));
}

}  // namespace msf
