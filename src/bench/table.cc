#include "bench/table.h"

#include <fmt/format.h>

#include <algorithm>

#include "util/markup.h"

namespace msf {
namespace {

// The headings of both levels in one.
std::vector<std::string> FlatColumns(const Table& table) {
  std::vector<std::string> columns = table.columns;
  size_t at = 0;
  for (const auto& [text, count] : table.groups) {
    for (int i = 0; i < count && at < columns.size(); ++i, ++at) {
      if (!text.empty()) columns[at] = text + (columns[at].empty() ? "" : ", " + columns[at]);
    }
  }
  return columns;
}

std::string TextOf(const Cell& cell) { return cell.text.empty() ? "-" : cell.text; }

std::string MarkdownText(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '|' || c == '*') escaped += '\\';
    escaped += c;
  }
  return escaped;
}

std::string CsvText(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

std::string HtmlHead(const Table& table) {
  std::string html = "<thead>\n";
  if (!table.groups.empty()) {
    html += "<tr>";
    for (const auto& [text, count] : table.groups)
      html += fmt::format("<th colspan=\"{}\" class=\"group\">{}</th>", count, EscapeMarkup(text));
    html += "</tr>\n";
  }
  html += "<tr>";
  for (size_t i = 0; i < table.columns.size(); ++i) {
    html += fmt::format("<th class=\"{}\">{}</th>",
                        i < static_cast<size_t>(table.num_label_columns) ? "label" : "",
                        EscapeMarkup(table.columns[i]));
  }
  return html + "</tr>\n</thead>\n";
}

}  // namespace

std::string TableToMarkdown(const Table& table) {
  std::string text = "### " + table.title + "\n\n|";
  for (const std::string& column : FlatColumns(table))
    text += fmt::format(" {} |", MarkdownText(column));
  text += "\n|";
  for (size_t i = 0; i < table.columns.size(); ++i)
    text += i < static_cast<size_t>(table.num_label_columns) ? "---|" : "---:|";
  text += "\n";
  for (const std::vector<Cell>& row : table.rows) {
    text += "|";
    for (const Cell& cell : row) {
      const std::string shown = MarkdownText(TextOf(cell));
      const char* mark = cell.published && !cell.text.empty() ? "*" : "";
      text += fmt::format(" {0}{1}{0} |", mark, shown);
    }
    text += "\n";
  }
  if (!table.note.empty()) text += fmt::format("\n{}\n", table.note);
  return text + "\n";
}

std::string TableToHtml(const Table& table) {
  std::string html = fmt::format("<h3 id=\"{}\">{}</h3>\n<div class=\"wide\"><table>\n{}<tbody>\n",
                                 table.id, EscapeMarkup(table.title), HtmlHead(table));
  for (const std::vector<Cell>& row : table.rows) {
    const bool all_published = std::all_of(row.begin(), row.end(), [](const Cell& cell) {
      return cell.published || cell.text.empty();
    });
    html += all_published ? "<tr class=\"published\">" : "<tr>";
    for (size_t i = 0; i < row.size(); ++i) {
      const bool label = i < static_cast<size_t>(table.num_label_columns);
      const char* kind =
          row[i].published ? (label ? "label published" : "published") : (label ? "label" : "");
      html += fmt::format("<td class=\"{}\">{}</td>", kind, EscapeMarkup(TextOf(row[i])));
    }
    html += "</tr>\n";
  }
  html += "</tbody></table></div>\n";
  return html +
         (table.note.empty() ? "" : "<p class=\"note\">" + EscapeMarkup(table.note) + "</p>\n");
}

std::string TableToCsv(const Table& table) {
  std::string csv;
  const auto add_row = [&csv](const auto& cells, auto text_of) {
    const char* comma = "";
    for (const auto& cell : cells) {
      csv += comma;
      csv += CsvText(text_of(cell));
      comma = ",";
    }
    csv += "\n";
  };
  add_row(FlatColumns(table), [](const std::string& column) { return column; });
  for (const std::vector<Cell>& row : table.rows)
    add_row(row, [](const Cell& cell) { return cell.text; });
  return csv;
}

}  // namespace msf
