// Tables of the report: as markdown, HTML and CSV.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace msf {

struct Cell {
  // Implicit: rows read as lists of texts.
  Cell() = default;
  Cell(std::string what, bool from_the_literature = false)  // NOLINT(google-explicit-constructor)
      : text(std::move(what)), published(from_the_literature) {}
  Cell(const char* what, bool from_the_literature = false)  // NOLINT(google-explicit-constructor)
      : text(what), published(from_the_literature) {}

  std::string text;        // empty: "-"
  bool published = false;  // not measured by us
};

struct Table {
  std::string id;     // file name of its CSV
  std::string title;  // "Table 5: ..."
  std::string note;   // below it
  // Headings over several columns: text, number of columns. Empty, or they add up to all columns.
  std::vector<std::pair<std::string, int>> groups;
  std::vector<std::string> columns;
  std::vector<std::vector<Cell>> rows;
  int num_label_columns = 1;  // text, to the left
};

// A heading of the level "###", the table with published figures in italics, the note.
std::string TableToMarkdown(const Table& table);
// The same with <h3>; published figures have the class "published".
std::string TableToHtml(const Table& table);
// One heading per column; a "-" is an empty cell.
std::string TableToCsv(const Table& table);

}  // namespace msf
