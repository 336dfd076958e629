#include "io/trajectory_formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "io/text_rows.h"

namespace msf {
namespace {

constexpr size_t kTumColumns = 8, kKittiColumns = 12;
constexpr double kNanoseconds = 1e-9;
// Seconds since 1970 stay below for 30,000 years; nanoseconds are above since eleven days after it.
constexpr double kLargestSeconds = 1e12;

struct NumberRow {
  int line = 0;
  bool has_commas = false;
  std::vector<double> values;
};

StatusOr<NumberRow> ParseRow(const std::filesystem::path& file, const TextRow& row) {
  NumberRow numbers;
  numbers.line = row.line;
  for (std::string column : row.columns) {
    std::replace(column.begin(), column.end(), ',', ' ');
    size_t at = 0;
    numbers.has_commas = numbers.has_commas || column.find(' ') != std::string::npos;
    while ((at = column.find_first_not_of(' ', at)) != std::string::npos) {
      const size_t end = std::min(column.find(' ', at), column.size());
      const std::string word = column.substr(at, end - at);
      const std::optional<double> number = ParseFiniteNumber(word);
      if (!number) return RowError(file, row.line, "'" + word + "' is not a finite number");
      numbers.values.push_back(*number);
      at = end;
    }
  }
  return numbers;
}

StatusOr<StampedPose> PoseOf(const std::filesystem::path& file, const NumberRow& row, double time_s,
                             const Eigen::Quaterniond& rotation) {
  constexpr double kSmallestNorm = 1e-6;
  if (rotation.norm() < kSmallestNorm) return RowError(file, row.line, "the quaternion is zero");
  const std::vector<double>& v = row.values;
  return StampedPose{time_s, Rigid3d(rotation, Eigen::Vector3d(v[1], v[2], v[3]))};
}

StatusOr<StampedPose> ParseStamped(const std::filesystem::path& file, const NumberRow& row) {
  const std::vector<double>& v = row.values;
  if (v.size() < kTumColumns || (!row.has_commas && v.size() > kTumColumns)) {
    return RowError(
        file, row.line,
        fmt::format("is no pose of TUM (8 columns), KITTI (12) or EuRoC (8 or more with "
                    "commas); it has {}",
                    v.size()));
  }
  const double time_s = v[0] > kLargestSeconds ? v[0] * kNanoseconds : v[0];
  // EuRoC's ground truth has the real part first, TUM's last.
  return PoseOf(file, row, time_s,
                row.has_commas ? Eigen::Quaterniond(v[4], v[5], v[6], v[7])
                               : Eigen::Quaterniond(v[7], v[4], v[5], v[6]));
}

StampedPose ParseMatrix(const NumberRow& row, double time_s) {
  const std::vector<double>& v = row.values;
  Eigen::Matrix3d rotation;
  rotation << v[0], v[1], v[2], v[4], v[5], v[6], v[8], v[9], v[10];
  return {time_s, Rigid3d(rotation, Eigen::Vector3d(v[3], v[7], v[11]))};
}

StatusOr<Trajectory> ParseKitti(const std::filesystem::path& file,
                                const std::vector<NumberRow>& rows,
                                std::span<const double> frame_times_s) {
  if (rows.size() != frame_times_s.size()) {
    return Status::Error(
        fmt::format("{}: has {} poses in KITTI's form, which has no time stamps, for {} frames",
                    file.string(), rows.size(), frame_times_s.size()));
  }
  Trajectory trajectory;
  for (size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].values.size() != kKittiColumns)
      return RowError(file, rows[i].line, "a pose in KITTI's form has 12 columns");
    trajectory.push_back(ParseMatrix(rows[i], frame_times_s[i]));
  }
  return trajectory;
}

}  // namespace

StatusOr<Trajectory> ReadForeignTrajectory(const std::filesystem::path& file,
                                           std::span<const double> frame_times_s) {
  const StatusOr<std::vector<TextRow>> text = ReadTextRows(file);
  if (!text.ok()) return text.status();
  std::vector<NumberRow> rows;
  for (const TextRow& line : *text) {
    StatusOr<NumberRow> row = ParseRow(file, line);
    if (!row.ok()) return row.status();
    rows.push_back(*std::move(row));
  }
  if (rows.empty()) return Status::Error(file.string() + ": holds no pose");
  const bool is_kitti = !rows.front().has_commas && rows.front().values.size() == kKittiColumns;
  if (is_kitti) return ParseKitti(file, rows, frame_times_s);
  Trajectory trajectory;
  for (const NumberRow& row : rows) {
    StatusOr<StampedPose> pose = ParseStamped(file, row);
    if (!pose.ok()) return pose.status();
    if (!trajectory.empty() && pose->time_s < trajectory.back().time_s)
      return RowError(file, row.line, "the time stamp lies before that of the previous pose");
    trajectory.push_back(*pose);
  }
  return trajectory;
}

}  // namespace msf
