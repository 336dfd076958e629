#include "simulation/walk_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace msf {
namespace {

constexpr double kRamp_s = 0.6;  // to full speed and to a halt

// Distance walked `time_s` after a start at rest that ends at rest after `length_m`, at most
// `speed`; time ramps linear in speed.
struct Ramp {
  double length_m, speed_m_s, ramp_s;

  Ramp(double length, double speed) : length_m(length), speed_m_s(speed), ramp_s(kRamp_s) {
    if (length < speed * ramp_s) speed_m_s = length / ramp_s;  // too short to reach full speed
  }
  double duration_s() const { return length_m / speed_m_s + ramp_s; }
  double SpeedAt(double t) const {
    return speed_m_s * std::clamp(std::min(t, duration_s() - t) / ramp_s, 0., 1.);
  }
  double DistanceAt(double t) const {
    t = std::clamp(t, 0., duration_s());
    const double rest = duration_s() - t;
    if (t < ramp_s) return 0.5 * speed_m_s * t * t / ramp_s;
    if (rest < ramp_s) return length_m - 0.5 * speed_m_s * rest * rest / ramp_s;
    return speed_m_s * (t - 0.5 * ramp_s);
  }
};

}  // namespace

Status WalkPath::Check(const std::vector<Station>& stations, double speed_m_s) {
  if (stations.empty()) return Status::Error("stations must not be empty");
  if (!(speed_m_s > 0 && speed_m_s < 5)) return Status::Error("speed_m_s must be in (0, 5)");
  for (size_t i = 1; i < stations.size(); ++i) {
    if (std::hypot(stations[i].x - stations[i - 1].x, stations[i].y - stations[i - 1].y) < 0.1) {
      return Status::Error("stations must be at least 0.1 m apart");
    }
  }
  return Status::Ok();
}

WalkPath::WalkPath(std::vector<Station> stations, bool closed, double speed_m_s, double heading_deg)
    : stations_(std::move(stations)),
      closed_(closed && stations_.size() > 1),
      speed_m_s_(speed_m_s) {
  const double heading = heading_deg * std::numbers::pi / 180;
  resting_heading_ = {std::cos(heading), std::sin(heading)};
  double length = 0;
  station_m_.push_back(0);
  for (size_t i = 1; i < stations_.size() + (closed_ ? 1 : 0); ++i) {
    const Station &a = stations_[i - 1], &b = stations_[i % stations_.size()];
    length += std::hypot(b.x - a.x, b.y - a.y);
    station_m_.push_back(length);
  }
  double begin_m = 0;
  for (size_t i = 1; i < station_m_.size(); ++i) {
    const double pause_s = stations_[i % stations_.size()].pause_s;
    const bool is_last = i + 1 == station_m_.size();
    if (pause_s <= 0 && !is_last) continue;
    AddStage(begin_m, station_m_[i], pause_s);
    begin_m = station_m_[i];
  }
}

void WalkPath::AddStage(double begin_m, double end_m, double pause_s) {
  double begin_s = 0;
  if (!stages_.empty())
    begin_s = stages_.back().begin_s + stages_.back().walk_s + stages_.back().pause_s;
  const double length_m = end_m - begin_m;
  stages_.push_back({begin_s, Ramp(length_m, speed_m_s_).duration_s(), pause_s, begin_m, length_m});
}

WalkPath::Progress WalkPath::ProgressAt(double time_s) const {
  if (stages_.empty()) return {};
  const bool never_stops = closed_ && stages_.size() == 1 && stages_[0].pause_s <= 0;
  if (never_stops) return {speed_m_s_ * time_s, 1};
  double rounds = 0;
  if (closed_) {
    const double period_s = stages_.back().begin_s + stages_.back().walk_s + stages_.back().pause_s;
    rounds = std::floor(time_s / period_s);
    time_s -= rounds * period_s;
  }
  const Stage* stage = &stages_.front();
  for (const Stage& candidate : stages_) {
    if (time_s >= candidate.begin_s) stage = &candidate;
  }
  const Ramp ramp(stage->length_m, speed_m_s_);
  const double elapsed_s = time_s - stage->begin_s;
  return {rounds * station_m_.back() + stage->begin_m + ramp.DistanceAt(elapsed_s),
          ramp.SpeedAt(elapsed_s) / speed_m_s_};
}

Eigen::Vector2d WalkPath::OnPolyline(double distance_m) const {
  const double length_m = station_m_.back();
  if (closed_) distance_m -= std::floor(distance_m / length_m) * length_m;
  distance_m = std::clamp(distance_m, 0., length_m);
  const auto next = std::upper_bound(station_m_.begin() + 1, station_m_.end() - 1, distance_m);
  const size_t i = static_cast<size_t>(next - station_m_.begin());
  const Station &a = stations_[i - 1], &b = stations_[i % stations_.size()];
  const double t = (distance_m - station_m_[i - 1]) / (station_m_[i] - station_m_[i - 1]);
  return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
}

Eigen::Vector2d WalkPath::PlaceAt(double distance_m) const {
  if (stations_.size() == 1) return {stations_[0].x, stations_[0].y};
  constexpr int kHalf = 12;
  constexpr double kReach_m = 0.6;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double total = 0;
  for (int i = -kHalf; i <= kHalf; ++i) {
    const double offset = static_cast<double>(i) / kHalf;
    const double weight = std::pow(1 - offset * offset, 2) + 1e-9;
    sum += weight * OnPolyline(distance_m + kReach_m * offset);
    total += weight;
  }
  return sum / total;
}

Eigen::Vector2d WalkPath::HeadingAt(double distance_m) const {
  const Eigen::Vector2d along = PlaceAt(distance_m + 0.15) - PlaceAt(distance_m - 0.15);
  return along.norm() > 1e-6 ? along.normalized() : resting_heading_;
}

}  // namespace msf
