#include "simulation/camera_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace msf {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kStart_s = 0.8;  // time that a motion takes to set in

double Radians(double degrees) { return degrees * kPi / 180; }

double Sway(double time_s, double period_s) {
  return (1 - std::exp(-time_s / kStart_s)) * std::sin(2 * kPi * time_s / period_s);
}

}  // namespace

Status CameraPathOptions::Check() const {
  const std::vector<std::string> kinds = {"xyz", "rpy", "halfsphere", "static", "waypoints"};
  if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) {
    return Status::Error("path.kind is '" + kind +
                         "'; known are xyz, rpy, halfsphere, static, waypoints");
  }
  if (!(period_s > 0 && speed_m_s > 0 && radius_m > 0)) {
    return Status::Error("path: period_s, speed_m_s and radius_m must be positive");
  }
  if (kind != "waypoints") return Status::Ok();
  if (waypoints.size() < 2) return Status::Error("path.waypoints needs at least two stations");
  for (size_t i = 1; i < waypoints.size(); ++i) {
    const Waypoint &a = waypoints[i - 1], &b = waypoints[i];
    if (std::hypot(b.x - a.x, b.y - a.y, b.z - a.z) < 1e-3) {
      return Status::Error("path.waypoints: station " + std::to_string(i) +
                           " is where the one before it is");
    }
  }
  return Status::Ok();
}

Rigid3d LookAlong(const Waypoint& view, double roll_deg) {
  const double yaw = Radians(view.yaw_deg), pitch = Radians(view.pitch_deg);
  const Eigen::Vector3d forward(std::cos(yaw) * std::cos(pitch), std::sin(yaw) * std::cos(pitch),
                                std::sin(pitch));
  const Eigen::Vector3d right(std::sin(yaw), -std::cos(yaw), 0);
  Eigen::Matrix3d R_wc;
  R_wc << right, forward.cross(right), forward;
  const Eigen::AngleAxisd roll(Radians(roll_deg), Eigen::Vector3d::UnitZ());
  return {Eigen::Matrix3d(R_wc * roll.toRotationMatrix()), Eigen::Vector3d(view.x, view.y, view.z)};
}

CameraPath::CameraPath(const CameraPathOptions& options, Random random) : options_(options) {
  for (int axis = 0; axis < 6; ++axis) {
    for (const double frequency_hz : {0.5, 1.1, 2.3, 4.7, 7.9}) {
      // Weaker when faster: a hand drifts slowly and shakes a little. The weights' squares sum to
      // about 2.
      const double amplitude = 1 / (0.8 + frequency_hz);
      tremors_[axis].push_back(
          {amplitude, frequency_hz * random.Uniform(0.85, 1.15), random.Uniform(0, 2 * kPi)});
    }
  }
  double length = 0;
  const std::vector<Waypoint>& stations = options_.waypoints;
  for (size_t i = 0; i < stations.size() + (options_.closed ? 1 : 0); ++i) {
    if (i > 0) {
      const Waypoint &a = stations[i - 1], &b = stations[i % stations.size()];
      length += std::hypot(b.x - a.x, b.y - a.y, b.z - a.z);
    }
    station_m_.push_back(length);
  }
}

Rigid3d CameraPath::PoseAt(double time_s) const {
  double shake[6];
  for (int axis = 0; axis < 6; ++axis) {
    shake[axis] = 0;
    for (const Tremor& tremor : tremors_[axis]) {
      shake[axis] +=
          tremor.amplitude * std::sin(2 * kPi * tremor.frequency_hz * time_s + tremor.phase);
    }
    shake[axis] *= axis < 3 ? options_.tremor_m : Radians(options_.tremor_deg);
  }
  const Eigen::Vector3d shift(shake[0], shake[1], shake[2]), turn(shake[3], shake[4], shake[5]);
  return Carried(time_s) * Rigid3d(ExpRotation(turn), shift);
}

Rigid3d CameraPath::Carried(double time_s) const {
  if (options_.kind == "waypoints") return AlongWaypoints(time_s);
  if (options_.kind == "halfsphere") return OnHalfSphere(time_s);
  const double period_s = options_.period_s;
  const double slow = Sway(time_s, 1.61 * period_s), medium = Sway(time_s, 1.27 * period_s),
               fast = Sway(time_s, period_s);
  if (options_.kind == "xyz") {
    const Eigen::Vector3d offset_c(slow, 0.75 * fast, medium);
    return LookAlong(options_.base) *
           Rigid3d(Eigen::Quaterniond::Identity(), options_.amplitude_m * offset_c);
  }
  if (options_.kind == "rpy") {
    Waypoint view = options_.base;
    view.yaw_deg += options_.amplitude_deg * slow;
    view.pitch_deg += 0.7 * options_.amplitude_deg * medium;
    return LookAlong(view, 0.9 * options_.amplitude_deg * fast);
  }
  return LookAlong(options_.base);
}

Rigid3d CameraPath::OnHalfSphere(double time_s) const {
  // Around the point `base`, south of it, rising and sinking while going to and fro.
  const double azimuth =
      Radians(-90 + options_.amplitude_deg * Sway(time_s, 2.6 * options_.period_s));
  const double elevation =
      Radians(30 + 0.5 * options_.amplitude_deg * Sway(time_s, 1.7 * options_.period_s));
  const Eigen::Vector3d from_target(std::cos(elevation) * std::cos(azimuth),
                                    std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
  Waypoint view = options_.base;
  view.x += options_.radius_m * from_target.x();
  view.y += options_.radius_m * from_target.y();
  view.z += options_.radius_m * from_target.z();
  view.yaw_deg = azimuth * 180 / kPi + 180;
  view.pitch_deg = -elevation * 180 / kPi;
  return LookAlong(view);
}

Waypoint CameraPath::StationAt(double distance_m) const {
  const std::vector<Waypoint>& stations = options_.waypoints;
  const double length = station_m_.back();
  double turns = 0;
  if (options_.closed) {
    turns = std::floor(distance_m / length);
    distance_m -= turns * length;
  }
  distance_m = std::clamp(distance_m, 0., length);
  const auto next = std::upper_bound(station_m_.begin() + 1, station_m_.end() - 1, distance_m);
  const size_t i = static_cast<size_t>(next - station_m_.begin());
  const double t = (distance_m - station_m_[i - 1]) / (station_m_[i] - station_m_[i - 1]);
  const Waypoint& a = stations[i - 1];
  Waypoint b = stations[i % stations.size()];
  // One turn of the loop may turn the view by a full circle.
  const double turn_deg =
      360 * std::round((stations.back().yaw_deg - stations.front().yaw_deg) / 360);
  if (i == stations.size()) b.yaw_deg += turn_deg;
  const auto mix = [t](double from, double to) { return from + t * (to - from); };
  return {mix(a.x, b.x), mix(a.y, b.y), mix(a.z, b.z), mix(a.yaw_deg, b.yaw_deg) + turns * turn_deg,
          mix(a.pitch_deg, b.pitch_deg)};
}

Rigid3d CameraPath::AlongWaypoints(double time_s) const {
  const double distance_m =
      options_.speed_m_s * (time_s - kStart_s * (1 - std::exp(-time_s / kStart_s)));
  // The mean over a stretch of the polyline, weighted by a bell, rounds its corners: where the way
  // bends the walker cuts it.
  constexpr int kHalf = 24;
  constexpr double kReach_m = 1.1;
  Waypoint sum{0, 0, 0, 0, 0};
  double total = 0;
  for (int i = -kHalf; i <= kHalf; ++i) {
    const double offset = static_cast<double>(i) / kHalf;
    const double weight = std::pow(1 - offset * offset, 2) + 1e-9;
    const Waypoint station = StationAt(distance_m + kReach_m * offset);
    sum.x += weight * station.x;
    sum.y += weight * station.y;
    sum.z += weight * station.z;
    sum.yaw_deg += weight * station.yaw_deg;
    sum.pitch_deg += weight * station.pitch_deg;
    total += weight;
  }
  return LookAlong(
      {sum.x / total, sum.y / total, sum.z / total, sum.yaw_deg / total, sum.pitch_deg / total});
}

}  // namespace msf
