#include "evaluation/label_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <optional>
#include <ostream>
#include <string_view>

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

// The cells of one row, and the numbers among them.
class Row {
 public:
  explicit Row(std::string_view line) {
    while (true) {
      const size_t comma = line.find(',');
      cells_.push_back(line.substr(0, comma));
      if (comma == std::string_view::npos) return;
      line.remove_prefix(comma + 1);
    }
  }
  size_t size() const { return cells_.size(); }
  std::string_view operator[](size_t i) const { return cells_[i]; }
  // Not a number: 0, and ok() is false from then on.
  double Number(size_t i) {
    const std::optional<double> number = ParseFiniteNumber(cells_[i]);
    ok_ = ok_ && number;
    return number.value_or(0);
  }
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
  const LabelledPoint point = {static_cast<float>(row.Number(2)), static_cast<float>(row.Number(3)),
                               static_cast<float>(row.Number(5)), *reason};
  FrameOf(frames, static_cast<int64_t>(row.Number(0)), row.Number(1)).points.push_back(point);
  return row.ok();
}

bool TakeObject(Row& row, std::vector<LabelledFrame>& frames) {
  LabelledObject object;
  object.id = static_cast<int>(row.Number(2));
  object.name = row[3];
  object.kind = row[4];
  object.state = row[5];
  object.removed = row.Number(6) != 0;
  object.bridged = row.Number(7) != 0;
  object.score = static_cast<float>(row.Number(8));
  object.box = {static_cast<float>(row.Number(9)), static_cast<float>(row.Number(10)),
                static_cast<float>(row.Number(11)), static_cast<float>(row.Number(12))};
  const auto id = static_cast<int64_t>(row.Number(0));
  const auto frame =
      std::lower_bound(frames.begin(), frames.end(), id,
                       [](const LabelledFrame& f, int64_t wanted) { return f.frame < wanted; });
  if (frame != frames.end() && frame->frame == id) frame->objects.push_back(std::move(object));
  return row.ok();
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
                           frame.frame, frame.time_s, object.id, object.name, object.kind,
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
  if (std::filesystem::exists(objects))
    MSF_RETURN_IF_ERROR(
        ReadCsv(objects, kObjectsHeader, [&](Row& row) { return TakeObject(row, frames); }));
  return frames;
}

}  // namespace msf
