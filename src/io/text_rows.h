// Text files of rows and columns, as the TUM tools write them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "util/status.h"

namespace msf {

struct TextRow {
  int line = 0;                      // from 1
  std::vector<std::string> columns;  // what white space separates; at least one
};

// The rows of a file without comments ('#' to the end of the line), empty lines and the byte order
// mark that it may begin with; an error when it cannot be read.
StatusOr<std::vector<TextRow>> ReadTextRows(const std::filesystem::path& file);

// The finite number that the whole of `text` says, or nothing. Does not depend on the locale.
std::optional<double> ParseFiniteNumber(std::string_view text);

// "file:line: what", the form of all complaints about rows.
Status RowError(const std::filesystem::path& file, int line, const std::string& what);

}  // namespace msf
