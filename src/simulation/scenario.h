// A scenario: where a simulated camera goes, through which world, and how well it sees. A small
// YAML file.
#pragma once

#include <string>
#include <vector>

#include "simulation/camera_path.h"
#include "simulation/cast.h"
#include "simulation/color_sensor.h"
#include "simulation/depth_sensor.h"
#include "util/status.h"

namespace msf {

// A span of time since the start.
struct TimeSpan {
  double from_s = 0;
  double to_s = 0;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("from_s", from_s, "start");
    visit("to_s", to_s, "end");
  }
};

// Poor light from `from_s` to `to_s`: what is seen is darker, the camera's noise is not.
struct Dimming {
  double from_s = 0;
  double to_s = 0;
  double level = 0.2;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("from_s", from_s, "start");
    visit("to_s", to_s, "end");
    visit("level", level, "share of the usual light, 0..1");
  }
};

// At `time_s` the camera is put to where its path is at `path_time_s`, and goes on from there.
struct Jump {
  double time_s = 0;
  double path_time_s = 0;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("time_s", time_s, "when the camera is moved");
    visit("path_time_s", path_time_s, "time of the path where it goes on");
  }
};

struct Scenario {
  std::string name = "unnamed";
  std::string description;
  std::string world = "office";
  std::string camera = "simulated";
  double focal_error = 0;
  double duration_s = 25;
  double start_time_s = 1000;
  double fps = 30;
  double time_jitter_s = 0.0005;
  CameraPathOptions path;
  ColorSensorOptions color;
  DepthSensorOptions depth;
  std::vector<TimeSpan> blackouts;
  std::vector<TimeSpan> depth_gaps;
  std::vector<Dimming> dimmings;
  std::vector<Jump> jumps;
  std::vector<ActorOptions> actors;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("name", name, "of the scenario");
    visit("description", description, "what it is for");
    visit("world", world, "office or two_rooms");
    visit("camera", camera, "a camera preset");
    visit("focal_error", focal_error,
          "the true focal length exceeds the calibrated one by this share: what a calibration "
          "misses");
    visit("duration_s", duration_s, "length of the sequence");
    visit("start_time_s", start_time_s, "time stamp of the first frame, s");
    visit("fps", fps, "frame rate, Hz");
    visit("time_jitter_s", time_jitter_s, "standard deviation of the frames' times");
    visit("path", path, "");
    visit("color", color, "");
    visit("depth", depth, "");
    visit("blackouts", blackouts, "pictures are black and there is no depth");
    visit("depth_gaps", depth_gaps, "no depth, as in sunlight, which blinds the sensor");
    visit("dimmings", dimmings, "");
    visit("jumps", jumps, "");
    visit("actors", actors, "");
  }
  // A sentence when a value makes no sense.
  Status Check() const;

  // Share of the usual light at a time since the start; it changes within 0.2 s.
  double LightAt(double elapsed_s) const;
};

// The scenario of that name that is built in, else the one in the YAML file of that name. Errors
// list the names.
StatusOr<Scenario> LoadScenario(const std::string& name_or_file);
std::vector<std::string> ScenarioNames();

}  // namespace msf
