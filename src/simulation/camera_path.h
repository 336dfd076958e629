// How the simulated camera is carried through the world: smooth curves plus the tremor of a hand.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "geometry/rigid3d.h"
#include "simulation/random.h"
#include "util/status.h"

namespace msf {

// Where the camera is and looks. Yaw 0 looks east (+x), 90 north (+y); pitch below 0 looks down.
struct Waypoint {
  double x = 0, y = 0, z = 1.4;       // m
  double yaw_deg = 0, pitch_deg = 0;  // may exceed 360 so that turns have a direction

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("x", x, "east, m");
    visit("y", y, "north, m");
    visit("z", z, "height, m");
    visit("yaw_deg", yaw_deg, "0 looks east, 90 north; may exceed 360");
    visit("pitch_deg", pitch_deg, "below 0 looks down");
  }
};

struct CameraPathOptions {
  std::string kind = "xyz";
  Waypoint base{3.1, 1.35, 1.3, 90, -18};
  double amplitude_m = 0.22;
  double amplitude_deg = 22;
  double period_s = 4;
  double radius_m = 1.3;
  double speed_m_s = 0.6;
  bool closed = false;
  double tremor_m = 0.002;
  double tremor_deg = 0.2;
  std::vector<Waypoint> waypoints;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("kind", kind, "xyz, rpy, halfsphere, static or waypoints");
    visit("base", base, "middle of the motion; for halfsphere yaw and pitch are ignored");
    visit("amplitude_m", amplitude_m, "of the translation (xyz)");
    visit("amplitude_deg", amplitude_deg, "of the rotation (rpy), of the arc (halfsphere)");
    visit("period_s", period_s, "of the fastest sway");
    visit("radius_m", radius_m, "distance from `base`, which is looked at (halfsphere)");
    visit("speed_m_s", speed_m_s, "along waypoints");
    visit("closed", closed, "waypoints: after the last comes the first again");
    visit("tremor_m", tremor_m, "hand tremor, standard deviation");
    visit("tremor_deg", tremor_deg, "hand tremor, standard deviation");
    visit("waypoints", waypoints, "stations of kind waypoints, walked with rounded corners");
  }
  Status Check() const;
};

// The pose of a camera at (x, y, z) that looks along yaw and pitch, rolled to the right by
// `roll_deg`.
Rigid3d LookAlong(const Waypoint& view, double roll_deg = 0);

class CameraPath {
 public:
  // `options` must pass Check().
  CameraPath(const CameraPathOptions& options, Random random);

  // T_wc at a time, s; smooth, the same whenever it is asked.
  Rigid3d PoseAt(double time_s) const;

 private:
  struct Tremor {
    double amplitude, frequency_hz, phase;
  };
  Rigid3d Carried(double time_s) const;
  Rigid3d OnHalfSphere(double time_s) const;
  Rigid3d AlongWaypoints(double time_s) const;
  Waypoint StationAt(double distance_m) const;

  CameraPathOptions options_;
  std::vector<double> station_m_;  // path length from the start to each waypoint (and back to the
                                   // first when closed)
  std::vector<Tremor> tremors_[6];
};

}  // namespace msf
