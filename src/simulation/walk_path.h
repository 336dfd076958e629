// Where somebody or something that moves over the floor is at any time: stations, pauses, rounded
// corners.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "util/status.h"

namespace msf {

struct Station {
  double x = 0, y = 0;  // m
  double pause_s = 0;   // stops there for so long

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("x", x, "east, m");
    visit("y", y, "north, m");
    visit("pause_s", pause_s, "stops there for so long");
  }
};

// A walk along stations. A closed one goes on from the last to the first, again and again; else it
// ends at the last. Somebody with a single station stays there.
class WalkPath {
 public:
  // Distance from the start at a time, and the share of full speed, 0..1.
  struct Progress {
    double distance_m = 0;
    double speed = 0;
  };

  // `heading_deg`: where a walk of one station looks; 0 = east, 90 = north.
  WalkPath(std::vector<Station> stations, bool closed, double speed_m_s, double heading_deg);
  static Status Check(const std::vector<Station>& stations, double speed_m_s);

  Progress ProgressAt(double time_s) const;
  // The place on the floor after a distance; where the way bends, corners are cut by up to half a
  // metre.
  Eigen::Vector2d PlaceAt(double distance_m) const;
  // The direction of the way there, unit.
  Eigen::Vector2d HeadingAt(double distance_m) const;

 private:
  // A stretch between two stops.
  struct Stage {
    double begin_s, walk_s,
        pause_s;  // when it begins, how long it is walked, how long is stopped at its end
    double begin_m, length_m;
  };
  void AddStage(double begin_m, double end_m, double pause_s);
  Eigen::Vector2d OnPolyline(double distance_m) const;

  std::vector<Station> stations_;
  bool closed_;
  double speed_m_s_;
  Eigen::Vector2d resting_heading_;
  std::vector<double> station_m_;
  std::vector<Stage> stages_;
};

}  // namespace msf
