#include <fmt/format.h>

#include "bench/base64.h"
#include "bench/report.h"
#include "util/markup.h"

namespace msf {
namespace {

// Nothing is fetched: no fonts, no scripts. Wide tables scroll on their own.
constexpr char kHead[] = R"html(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="icon" href="data:,">
<title>{title}</title>
<style>
body { font: 15px/1.5 "DejaVu Sans", Helvetica, Arial, sans-serif; color: #222; margin: 0 auto; max-width: 1240px; padding: 0 20px 60px; }
h1 { font-size: 26px; margin: 24px 0 8px; }
h2 { font-size: 20px; margin: 40px 0 8px; border-bottom: 2px solid #ccc; }
h3 { font-size: 16px; margin: 28px 0 6px; }
table { border-collapse: collapse; font-size: 12.5px; }
th, td { border: 1px solid #ccc; padding: 3px 6px; text-align: right; }
th { background: #eef1f5; font-weight: 600; }
th.group { text-align: center; }
.label { text-align: left; }
td.published, tr.published td { font-style: italic; color: #555; background: #faf6ea; }
.wide { overflow-x: auto; }
.note { font-size: 12.5px; color: #555; max-width: 1000px; margin: 4px 0; }
.missing, .problem { border-left: 4px solid #d08a00; background: #fdf5e2; padding: 4px 12px 4px 30px; }
.problem { border-color: #c33; background: #fdecea; }
figure { margin: 16px 0; }
figure img { max-width: 100%; height: auto; border: 1px solid #ddd; }
figcaption { font-size: 13px; color: #333; max-width: 1000px; }
nav a { margin-right: 14px; }
</style>
</head>
<body>
)html";

std::string Head(const std::string& title) {
  std::string head = kHead;
  const std::string mark = "{title}";
  return head.replace(head.find(mark), mark.size(), EscapeMarkup(title));
}

std::string List(const std::vector<std::string>& lines, const char* kind) {
  std::string html = fmt::format("<ul class=\"{}\">\n", kind);
  for (const std::string& line : lines) html += "<li>" + EscapeMarkup(line) + "</li>\n";
  return html + "</ul>\n";
}

// As pictures rather than parts of the page: names inside of one do not meet those of another.
std::string FigureToHtml(const Figure& figure) {
  // The title is in the picture.
  const std::string caption =
      figure.note.empty() ? "" : "<figcaption>" + EscapeMarkup(figure.note) + "</figcaption>";
  return fmt::format(
      "<figure id=\"{}\"><img alt=\"{}\" src=\"data:image/svg+xml;base64,{}\">{}</figure>\n",
      figure.id, EscapeMarkup(figure.title), EncodeBase64(figure.svg), caption);
}

std::string Navigation(const BenchResults& results) {
  std::string html = "<nav><a href=\"#tables\">Tables</a><a href=\"#figures\">Figures</a>";
  for (const SuiteSequence& sequence : results.suite.sequences) {
    if (!results.plan.FolderOf(sequence.name).empty())
      html += fmt::format("<a href=\"#sequence-{0}\">{0}</a>", EscapeMarkup(sequence.name));
  }
  return html + "</nav>\n";
}

std::string SequenceSections(const BenchResults& results, const std::vector<Figure>& figures) {
  std::string html;
  for (const SuiteSequence& sequence : results.suite.sequences) {
    if (results.plan.FolderOf(sequence.name).empty()) continue;
    html += fmt::format("<h2 id=\"sequence-{0}\">{0}</h2>\n", EscapeMarkup(sequence.name));
    for (const Figure& figure : figures) {
      if (figure.section == sequence.name) html += FigureToHtml(figure);
    }
  }
  return html;
}

}  // namespace

std::string HtmlReport(const BenchResults& results, const std::vector<Table>& tables,
                       const std::vector<Figure>& figures) {
  const ReportFacts facts = GatherFacts(results);
  const std::string title = "msf-slam bench: " + results.suite.name;
  std::string html = Head(title) + "<h1>" + EscapeMarkup(title) + "</h1>\n" + Navigation(results);
  html += List(facts.about, "about");
  if (!facts.missing.empty())
    html += "<h3>Not run: sequences that are not here</h3>\n" + List(facts.missing, "missing");
  if (!facts.problems.empty())
    html += "<h3>Did not succeed</h3>\n" + List(facts.problems, "problem");
  html += "<h2 id=\"tables\">Tables</h2>\n";
  for (const Table& table : tables) html += TableToHtml(table);
  html += "<p class=\"note\">" + EscapeMarkup(DescribeAbsentTables(tables)) + "</p>\n";
  html += "<h2 id=\"figures\">Figures</h2>\n";
  for (const Figure& figure : figures) {
    if (figure.section.empty()) html += FigureToHtml(figure);
  }
  return html + SequenceSections(results, figures) + "</body>\n</html>\n";
}

}  // namespace msf
