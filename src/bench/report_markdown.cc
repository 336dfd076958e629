#include <fmt/format.h>

#include "bench/report.h"

namespace msf {
namespace {

void AddList(const char* title, const std::vector<std::string>& lines, std::string& text) {
  if (lines.empty()) return;
  if (*title != '\0') text += fmt::format("## {}\n\n", title);
  for (const std::string& line : lines) text += "* " + line + "\n";
  text += "\n";
}

void AddFigures(const std::vector<Figure>& figures, bool of_sequences, std::string& text) {
  for (const Figure& figure : figures) {
    if (figure.section.empty() == of_sequences) continue;
    text += fmt::format("![{}](figures/{}.svg)\n\n", figure.title, figure.id);
    if (!figure.note.empty()) text += figure.note + "\n\n";
  }
}

}  // namespace

std::string MarkdownReport(const BenchResults& results, const std::vector<Table>& tables,
                           const std::vector<Figure>& figures) {
  const ReportFacts facts = GatherFacts(results);
  std::string text = fmt::format("# msf-slam bench: {}\n\n", results.suite.name);
  AddList("", facts.about, text);
  AddList("Not run: sequences that are not here", facts.missing, text);
  AddList("Did not succeed", facts.problems, text);
  text += "## Tables\n\n";
  for (const Table& table : tables) text += TableToMarkdown(table);
  if (const std::string absent = DescribeAbsentTables(tables); !absent.empty())
    text += absent + "\n\n";
  if (figures.empty()) return text;
  text += "## Figures\n\n";
  AddFigures(figures, false, text);
  text += "## Sequence by sequence\n\n";
  AddFigures(figures, true, text);
  return text;
}

}  // namespace msf
