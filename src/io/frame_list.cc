#include "io/frame_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "io/text_rows.h"

namespace msf {
namespace {

// A list may pair what AssociateByTime would not; a larger gap is a mistake.
constexpr double kMaxListedGap_s = 1;

std::string Count(size_t n, const char* singular, const char* plural) {
  return fmt::format("{} {}", n, n == 1 ? singular : plural);
}

// Parses the rows of `file` with `parse` (nothing for a row that makes no sense) and brings them
// into order.
template <typename Item, typename Parse>
StatusOr<std::vector<Item>> ReadList(const std::filesystem::path& file, const char* expected,
                                     std::vector<std::string>& warnings, Parse parse) {
  StatusOr<std::vector<TextRow>> rows = ReadTextRows(file);
  if (!rows.ok()) return rows.status();
  std::vector<Item> items;
  int first_bad_line = 0;
  for (const TextRow& row : *rows) {
    std::optional<Item> item = parse(row.columns);
    if (item)
      items.push_back(std::move(*item));
    else if (first_bad_line == 0)
      first_bad_line = row.line;
  }
  if (items.empty())
    return Status::Error(fmt::format("{}: has no line of the form '{}'", file.string(), expected));
  if (const size_t num_bad = rows->size() - items.size(); num_bad > 0) {
    warnings.push_back(fmt::format("{}: {} not of the form '{}' left out, the first is line {}",
                                   file.string(), Count(num_bad, "line", "lines"), expected,
                                   first_bad_line));
  }
  const auto earlier = [](const Item& a, const Item& b) { return a.time_s < b.time_s; };
  if (!std::is_sorted(items.begin(), items.end(), earlier)) {
    std::stable_sort(items.begin(), items.end(), earlier);
    warnings.push_back(file.string() + ": the time stamps are out of order and were sorted");
  }
  const auto same = [](const Item& a, const Item& b) { return a.time_s == b.time_s; };
  const auto repeated = std::unique(items.begin(), items.end(), same);
  if (const auto num_repeated = static_cast<size_t>(items.end() - repeated); num_repeated > 0) {
    items.erase(repeated, items.end());
    warnings.push_back(fmt::format("{}: {} with a repeated time stamp left out", file.string(),
                                   Count(num_repeated, "line", "lines")));
  }
  return items;
}

}  // namespace

StatusOr<std::vector<ListedImage>> ReadImageList(const std::filesystem::path& file,
                                                 std::vector<std::string>& warnings) {
  const std::filesystem::path folder = file.parent_path();
  return ReadList<ListedImage>(
      file, "timestamp path", warnings,
      [&](const std::vector<std::string>& columns) -> std::optional<ListedImage> {
        if (columns.size() != 2) return std::nullopt;
        const std::optional<double> time_s = ParseFiniteNumber(columns[0]);
        if (!time_s) return std::nullopt;
        return ListedImage{*time_s, folder / columns[1]};
      });
}

StatusOr<std::vector<FrameFiles>> ReadAssociations(const std::filesystem::path& file,
                                                   std::vector<std::string>& warnings) {
  const std::filesystem::path folder = file.parent_path();
  return ReadList<FrameFiles>(
      file, "t_rgb rgb t_depth depth, stamps at most 1 s apart", warnings,
      [&](const std::vector<std::string>& columns) -> std::optional<FrameFiles> {
        if (columns.size() != 4) return std::nullopt;
        const std::optional<double> color_s = ParseFiniteNumber(columns[0]);
        const std::optional<double> depth_s = ParseFiniteNumber(columns[2]);
        if (!color_s || !depth_s || std::abs(*color_s - *depth_s) > kMaxListedGap_s)
          return std::nullopt;
        return FrameFiles{*color_s, *depth_s, folder / columns[1], folder / columns[3]};
      });
}

std::vector<FrameFiles> AssociateByTime(const std::vector<ListedImage>& color,
                                        const std::vector<ListedImage>& depth) {
  struct Candidate {
    double gap_s;
    size_t color, depth;
  };
  std::vector<Candidate> candidates;
  size_t first = 0;
  for (size_t i = 0; i < color.size(); ++i) {
    while (first < depth.size() && depth[first].time_s <= color[i].time_s - kMaxColorDepthGap_s)
      ++first;
    for (size_t j = first;
         j < depth.size() && depth[j].time_s < color[i].time_s + kMaxColorDepthGap_s; ++j) {
      candidates.push_back({std::abs(depth[j].time_s - color[i].time_s), i, j});
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.gap_s < b.gap_s; });
  std::vector<bool> color_used(color.size()), depth_used(depth.size());
  std::vector<FrameFiles> frames;
  for (const Candidate& c : candidates) {
    if (color_used[c.color] || depth_used[c.depth]) continue;
    color_used[c.color] = depth_used[c.depth] = true;
    frames.push_back(
        {color[c.color].time_s, depth[c.depth].time_s, color[c.color].file, depth[c.depth].file});
  }
  std::sort(frames.begin(), frames.end(),
            [](const FrameFiles& a, const FrameFiles& b) { return a.time_s < b.time_s; });
  return frames;
}

}  // namespace msf
