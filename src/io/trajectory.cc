#include "io/trajectory.h"

#include <fmt/format.h>

#include <array>
#include <ostream>

#include "io/text_rows.h"
#include "util/atomic_file.h"

namespace msf {
namespace {

constexpr size_t kColumns = 8;
constexpr double kSmallestQuaternionNorm = 1e-6;

StatusOr<StampedPose> ParsePose(const std::filesystem::path& file, const TextRow& row) {
  if (row.columns.size() != kColumns) {
    return RowError(file, row.line,
                    "a pose has 8 columns (timestamp tx ty tz qx qy qz qw), this line has " +
                        std::to_string(row.columns.size()));
  }
  std::array<double, kColumns> v{};
  for (size_t i = 0; i < kColumns; ++i) {
    const std::optional<double> number = ParseFiniteNumber(row.columns[i]);
    if (!number)
      return RowError(
          file, row.line,
          "'" + row.columns[i] + "' is not a finite number; correct or remove the line");
    v[i] = *number;
  }
  const Eigen::Quaterniond rotation(v[7], v[4], v[5], v[6]);
  if (rotation.norm() < kSmallestQuaternionNorm) {
    return RowError(file, row.line,
                    "the quaternion (last four columns) is zero; correct or remove the line");
  }
  return StampedPose{v[0], Rigid3d(rotation, Eigen::Vector3d(v[1], v[2], v[3]))};
}

}  // namespace

StatusOr<Trajectory> ReadTrajectory(const std::filesystem::path& file) {
  StatusOr<std::vector<TextRow>> rows = ReadTextRows(file);
  if (!rows.ok()) return rows.status();
  if (rows->empty()) return Status::Error(file.string() + ": holds no pose");
  Trajectory trajectory;
  trajectory.reserve(rows->size());
  for (const TextRow& row : *rows) {
    StatusOr<StampedPose> pose = ParsePose(file, row);
    if (!pose.ok()) return pose.status();
    if (!trajectory.empty() && pose->time_s < trajectory.back().time_s) {
      return RowError(
          file, row.line,
          "the time stamp lies before that of the previous pose; sort the file by time");
    }
    trajectory.push_back(*pose);
  }
  return trajectory;
}

Status WriteTrajectory(const std::filesystem::path& file, const Trajectory& trajectory) {
  return WriteFileAtomically(file, [&](std::ostream& out) {
    for (const StampedPose& pose : trajectory) {
      const Eigen::Vector3d& t = pose.T_wc.translation();
      const Eigen::Quaterniond& q = pose.T_wc.rotation();
      out << fmt::format("{:.6f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", pose.time_s,
                         t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
    }
  });
}

}  // namespace msf
