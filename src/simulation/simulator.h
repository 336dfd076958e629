// The simulated camera: frames with exact poses, made one by one in memory.
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "geometry/rigid3d.h"
#include "io/trajectory.h"
#include "sensor/rgbd_frame.h"
#include "simulation/scenario.h"
#include "util/status.h"

namespace msf {

struct SimulatedFrame {
  RgbdFramePtr frame;
  Rigid3d T_wc;  // exact, camera optical frame (x right, y down, z forward) to world
  cv::Mat mask;  // 8-bit: 0 = static, else 1 + index of the actor that is seen there
};

// Frame i depends on the scenario, the seed and i only, in whatever order frames are asked for. Not
// for several threads at once.
class Simulator {
 public:
  // Builds the world. Errors: a scenario that fails Check().
  static StatusOr<Simulator> Create(const Scenario& scenario, uint64_t seed);
  Simulator(Simulator&&) noexcept;
  Simulator& operator=(Simulator&&) noexcept;
  ~Simulator();

  int num_frames() const;
  const Camera& camera() const;
  const Scenario& scenario() const;

  // What moves: mask value i stands for actor_classes()[i - 1], e.g. "person" or "box".
  const std::vector<std::string>& actor_classes() const;

  // Time stamp of frame `index`, s.
  double TimeOf(int index) const;
  // The camera's exact pose T_wc at a time stamp.
  Rigid3d PoseAt(double time_s) const;
  // `index` in [0, num_frames()).
  SimulatedFrame Render(int index);
  // The exact trajectory at 100 Hz over the time of all frames.
  Trajectory GroundTruth() const;

 private:
  struct Parts;
  explicit Simulator(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace msf
