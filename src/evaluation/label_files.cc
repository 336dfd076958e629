#include "evaluation/label_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <optional>
#include <ostream>
#include <string_view>

#include "io/presence.h"
#include "io/text_rows.h"
#include "util/atomic_file.h"

namespace msf {
namespace {

constexpr const char* kLabelsHeader = "frame,time_s,x,y,reason,static_probability";
constexpr const char* kObjectsHeader =
    "frame,time_s,id,class,kind,state,removed,bridged,score,x0,y0,x1,y1";

std::optional<PointReason> ReasonOf(std::string_view name) {
  for (int i = 0; i < kNumPointReasons; ++i) {
    if (name == ToString(static_cast<PointReason>(i))) return static_cast<PointReason>(i);
  }
  return std::nullopt;
}

// What numbers can be. An image is no larger; boxes may reach beyond it.
struct Range {
  double least, most;
};
constexpr Range kPixels = {-1, 16384};
constexpr Range kBoxSides = {-1e6, 1e6};
constexpr Range kFrames = {0, 1e15};
constexpr Range kIds = {std::numeric_limits<int>::min(), std::numeric_limits<int>::max()};
constexpr Range kShares = {0, 1};
constexpr Range kTimes_s = {-1e15, 1e15};

// The place of the comma that ends the first cell of `line`; a cell in quotes may hold commas.
size_t EndOfCell(std::string_view line) {
  bool in_quotes = false;
  for (size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') in_quotes = !in_quotes;
    if (line[i] == ',' && !in_quotes) return i;
  }
  return std::string_view::npos;
}

// The inverse of QuotedForCsv; what has no quotes stays as it is.
std::string Unquoted(std::string_view cell) {
  if (cell.size() < 2 || !cell.starts_with('"') || !cell.ends_with('"')) return std::string(cell);
  std::string text;
  for (size_t i = 1; i + 1 < cell.size(); ++i) {
    text += cell[i];
    if (cell[i] == '"') ++i;  // the first of two
  }
  return text;
}

// The cells of one row, and the numbers among them.
class Row {
 public:
  explicit Row(std::string_view line) {
    while (true) {
      const size_t comma = EndOfCell(line);
      cells_.push_back(line.substr(0, comma));
      if (comma == std::string_view::npos) return;
      line.remove_prefix(comma + 1);
    }
  }
  size_t size() const { return cells_.size(); }
  std::string_view operator[](size_t i) const { return cells_[i]; }
  // Not a number in the range: its least one, and ok() is false from then on.
  double Number(size_t i, Range range) {
    const std::optional<double> number = ParseFiniteNumber(cells_[i]);
    if (number && *number >= range.least && *number <= range.most) return *number;
    ok_ = false;
    return range.least;
  }
  float Float(size_t i, Range range) { return static_cast<float>(Number(i, range)); }
  bool ok() const { return ok_; }

 private:
  std::vector<std::string_view> cells_;
  bool ok_ = true;
};

// Calls `take` with every row below the header; it says whether the row made sense.
template <typename Take>
Status ReadCsv(const std::filesystem::path& file, std::string_view header, const Take& take) {
  std::ifstream stream(file);
  std::string line;
  if (!std::getline(stream, line))
    return Status::Error(file.string() + ": cannot be read or is empty");
  if (line != header) return RowError(file, 1, "the columns are not " + std::string(header));
  const size_t num_columns = Row(header).size();
  for (int number = 2; std::getline(stream, line); ++number) {
    Row row(line);
    if (row.size() != num_columns || !take(row))
      return RowError(file, number, fmt::format("'{}' makes no sense", line));
  }
  return Status::Ok();
}

// Rows of a frame follow each other, frames in order.
LabelledFrame& FrameOf(std::vector<LabelledFrame>& frames, int64_t id, double time_s) {
  if (frames.empty() || frames.back().frame != id) {
    frames.emplace_back();
    frames.back().frame = id;
    frames.back().time_s = time_s;
  }
  return frames.back();
}

bool TakePoint(Row& row, std::vector<LabelledFrame>& frames) {
  const std::optional<PointReason> reason = ReasonOf(row[4]);
  if (!reason) return false;
  const LabelledPoint point = {row.Float(2, kPixels), row.Float(3, kPixels), row.Float(5, kShares),
                               *reason};
  FrameOf(frames, static_cast<int64_t>(row.Number(0, kFrames)), row.Number(1, kTimes_s))
      .points.push_back(point);
  return row.ok();
}

bool TakeObject(Row& row, std::vector<LabelledFrame>& frames) {
  LabelledObject object;
  object.id = static_cast<int>(row.Number(2, kIds));
  object.name = Unquoted(row[3]);
  object.kind = row[4];
  object.state = row[5];
  object.removed = row.Number(6, kShares) != 0;
  object.bridged = row.Number(7, kShares) != 0;
  object.score = row.Float(8, kShares);
  object.box = {row.Float(9, kBoxSides), row.Float(10, kBoxSides), row.Float(11, kBoxSides),
                row.Float(12, kBoxSides)};
  const auto id = static_cast<int64_t>(row.Number(0, kFrames));
  const auto frame =
      std::lower_bound(frames.begin(), frames.end(), id,
                       [](const LabelledFrame& f, int64_t wanted) { return f.frame < wanted; });
  if (frame != frames.end() && frame->frame == id) frame->objects.push_back(std::move(object));
  return row.ok();
}

// Quotes are for names that need them; most readers of a CSV do without.
std::string NameCell(const std::string& name) {
  return name.find_first_of(",\"\n\r") == std::string::npos ? name : QuotedForCsv(name);
}

}  // namespace

LabelledFrame MakeLabelledFrame(const RgbdFrame& frame, const FrameFeatures& features,
                                const DynamicResult& result) {
  LabelledFrame labelled;
  labelled.frame = frame.id.value();
  labelled.time_s = frame.time_s;
  labelled.points.reserve(static_cast<size_t>(features.size()));
  for (int i = 0; i < features.size(); ++i) {
    labelled.points.push_back({features.image_px[i].x(), features.image_px[i].y(),
                               result.labels.static_probability[i], result.labels.reason[i]});
  }
  for (const DynamicObject& object : result.objects) {
    labelled.objects.push_back({object.id, object.name, ToString(object.kind),
                                ToString(object.state), object.removed, object.bridged,
                                object.score, object.box});
  }
  return labelled;
}

Status WriteLabels(const std::filesystem::path& file, const std::vector<LabelledFrame>& frames) {
  return WriteFileAtomically(file, [&](std::ostream& out) {
    out << kLabelsHeader << '\n';
    for (const LabelledFrame& frame : frames) {
      for (const LabelledPoint& point : frame.points) {
        out << fmt::format("{},{:.6f},{:.2f},{:.2f},{},{:.3f}\n", frame.frame, frame.time_s,
                           point.x_px, point.y_px, ToString(point.reason),
                           point.static_probability);
      }
    }
  });
}

Status WriteObjects(const std::filesystem::path& file, const std::vector<LabelledFrame>& frames) {
  return WriteFileAtomically(file, [&](std::ostream& out) {
    out << kObjectsHeader << '\n';
    for (const LabelledFrame& frame : frames) {
      for (const LabelledObject& object : frame.objects) {
        out << fmt::format("{},{:.6f},{},{},{},{},{:d},{:d},{:.3f},{:.1f},{:.1f},{:.1f},{:.1f}\n",
                           frame.frame, frame.time_s, object.id, NameCell(object.name), object.kind,
                           object.state, object.removed, object.bridged, object.score,
                           object.box.x0, object.box.y0, object.box.x1, object.box.y1);
      }
    }
  });
}

StatusOr<std::vector<LabelledFrame>> ReadLabels(const std::filesystem::path& file) {
  std::vector<LabelledFrame> frames;
  MSF_RETURN_IF_ERROR(
      ReadCsv(file, kLabelsHeader, [&](Row& row) { return TakePoint(row, frames); }));
  const std::filesystem::path objects = file.parent_path() / "objects.csv";
  if (IsThere(objects))
    MSF_RETURN_IF_ERROR(
        ReadCsv(objects, kObjectsHeader, [&](Row& row) { return TakeObject(row, frames); }));
  return frames;
}

std::string QuotedForCsv(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c == '\n' || c == '\r' ? ' ' : c;
  }
  return quoted + '"';
}

}  // namespace msf
