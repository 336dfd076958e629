#include "io/text_rows.h"

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>

#include "io/presence.h"

namespace msf {
namespace {

// Editors of other systems begin UTF-8 files with it.
constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

}  // namespace

StatusOr<std::vector<TextRow>> ReadTextRows(const std::filesystem::path& file) {
  errno = 0;
  std::ifstream stream(file);
  if (IsFolder(file)) return Status::Error(file.string() + ": cannot be opened (it is a folder)");
  if (!stream)
    return Status::Error(file.string() + ": cannot be opened (" + std::strerror(errno) + ")");
  std::vector<TextRow> rows;
  std::string text;
  for (int line = 1; std::getline(stream, text); ++line) {
    if (line == 1 && text.starts_with(kByteOrderMark)) text.erase(0, kByteOrderMark.size());
    std::istringstream words(text.substr(0, text.find('#')));
    TextRow row{line, {}};
    for (std::string word; words >> word;) row.columns.push_back(std::move(word));
    if (!row.columns.empty()) rows.push_back(std::move(row));
  }
  if (stream.bad()) return Status::Error(file.string() + ": cannot be read to its end");
  return rows;
}

std::optional<double> ParseFiniteNumber(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

Status RowError(const std::filesystem::path& file, int line, const std::string& what) {
  return Status::Error(file.string() + ":" + std::to_string(line) + ": " + what);
}

}  // namespace msf
