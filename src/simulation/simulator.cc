#include "simulation/simulator.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <utility>

#include "simulation/camera_path.h"
#include "simulation/lens.h"
#include "simulation/renderer.h"
#include "simulation/world.h"

namespace msf {
namespace {

// Keys of the random streams that belong to a seed.
enum Stream : uint64_t { kWorld = 1, kPath, kColor, kDepth, kTimes, kFrames, kCast };

// The camera that takes the pictures; the one that comes with them is calibrated with an error.
Camera TrueCamera(Camera camera, double focal_error) {
  camera.fx *= 1 + focal_error;
  camera.fy *= 1 + focal_error;
  return camera;
}

bool IsWithin(const std::vector<TimeSpan>& spans, double time_s) {
  return std::any_of(spans.begin(), spans.end(), [time_s](const TimeSpan& span) {
    return time_s >= span.from_s && time_s < span.to_s;
  });
}

}  // namespace

struct Simulator::Parts {
  Parts(const Scenario& scenario_in, const Camera& camera_in, SceneBuilder builder,
        Random random_in)
      : scenario(scenario_in),
        random(random_in),
        camera(std::make_shared<const Camera>(camera_in)),
        cast(scenario.actors, builder, random.Fork(kCast)),
        scene(std::move(builder).Finish()),
        path(scenario.path, random.Fork(kPath)),
        lens(TrueCamera(*camera, scenario.focal_error)),
        renderer(scene, lens.ideal()),
        color_sensor(scenario.color, *camera, random.Fork(kColor)),
        depth_sensor(scenario.depth, *camera, random.Fork(kDepth)) {}

  Scenario scenario;
  Random random;
  std::shared_ptr<const Camera> camera;
  Cast cast;
  Scene scene;
  CameraPath path;
  Lens lens;
  Renderer renderer;
  ColorSensor color_sensor;
  DepthSensor depth_sensor;
  RenderedView ideal_view, sub_view, view;

  void RenderView(double time_s);
  Rigid3d PoseAt(double time_s) const;
};

Rigid3d Simulator::Parts::PoseAt(double time_s) const {
  const double elapsed_s = time_s - scenario.start_time_s;
  double path_time_s = elapsed_s;
  for (const Jump& jump : scenario.jumps) {
    if (elapsed_s >= jump.time_s) path_time_s = jump.path_time_s + elapsed_s - jump.time_s;
  }
  return path.PoseAt(path_time_s);
}

void Simulator::Parts::RenderView(double time_s) {
  const auto render = [&](double at_s, bool color_only, RenderedView& out) {
    std::vector<PlacedMesh> movers = cast.At(at_s - scenario.start_time_s);
    for (PlacedMesh& mover : movers) Illuminate(scene.lights, mover.mesh);
    renderer.Render(PoseAt(at_s).Inverse(), movers, color_only, out);
  };
  render(time_s, false, ideal_view);
  const int samples = scenario.color.blur_samples;
  if (samples > 1) ideal_view.color.setTo(0);
  // Motion blur: the mean of pictures spread evenly over the exposure, whose middle is the frame's
  // time.
  for (int i = 0; i < samples && samples > 1; ++i) {
    render(time_s + scenario.color.shutter_s * ((i + 0.5) / samples - 0.5), true, sub_view);
    cv::scaleAdd(sub_view.color, 1.0 / samples, ideal_view.color, ideal_view.color);
  }
  lens.Apply(ideal_view, view);
}

StatusOr<Simulator> Simulator::Create(const Scenario& scenario, uint64_t seed) {
  MSF_RETURN_IF_ERROR(scenario.Check());
  StatusOr<Camera> camera = Camera::Preset(scenario.camera);
  if (!camera.ok()) return camera.status();
  camera->fps = scenario.fps;
  const Random random(seed);
  StatusOr<SceneBuilder> builder = BuildWorld(scenario.world, random.Fork(kWorld).Next());
  if (!builder.ok()) return builder.status();
  return Simulator(std::make_unique<Parts>(scenario, *camera, *std::move(builder), random));
}

Simulator::Simulator(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Simulator::Simulator(Simulator&&) noexcept = default;
Simulator& Simulator::operator=(Simulator&&) noexcept = default;
Simulator::~Simulator() = default;

int Simulator::num_frames() const {
  return static_cast<int>(parts_->scenario.duration_s * parts_->scenario.fps + 1e-9);
}

const Camera& Simulator::camera() const { return *parts_->camera; }
const Scenario& Simulator::scenario() const { return parts_->scenario; }

const std::vector<std::string>& Simulator::actor_classes() const { return parts_->cast.classes(); }

double Simulator::TimeOf(int index) const {
  Random jitter = parts_->random.Fork(kTimes).Fork(static_cast<uint64_t>(index));
  const Scenario& scenario = parts_->scenario;
  const double offset_s = std::clamp(jitter.Normal(), -3., 3.) * scenario.time_jitter_s;
  const double time_s = scenario.start_time_s + index / scenario.fps + (index == 0 ? 0 : offset_s);
  return std::round(time_s * 1e6) / 1e6;  // what a file keeps
}

Rigid3d Simulator::PoseAt(double time_s) const { return parts_->PoseAt(time_s); }

SimulatedFrame Simulator::Render(int index) {
  MSF_CHECK(index >= 0 && index < num_frames(), "no such frame");
  RgbdFrame frame;
  frame.id = FrameId(index);
  frame.time_s = TimeOf(index);
  frame.camera = parts_->camera;
  SimulatedFrame result;
  result.T_wc = PoseAt(frame.time_s);
  const double elapsed_s = frame.time_s - parts_->scenario.start_time_s;
  if (IsWithin(parts_->scenario.blackouts, elapsed_s)) {
    frame.color = cv::Mat::zeros(camera().height, camera().width, CV_8UC3);
    frame.depth = cv::Mat::zeros(camera().height, camera().width, CV_16UC1);
    result.mask = cv::Mat::zeros(camera().height, camera().width, CV_8UC1);
  } else {
    parts_->RenderView(frame.time_s);
    const RenderedView& view = parts_->view;
    const Random noise = parts_->random.Fork(kFrames).Fork(static_cast<uint64_t>(index));
    frame.color = parts_->color_sensor.Expose(view.color, elapsed_s,
                                              parts_->scenario.LightAt(elapsed_s), noise.Fork(1));
    frame.depth = parts_->depth_sensor.Measure(view, noise.Fork(2));
    if (IsWithin(parts_->scenario.depth_gaps, elapsed_s)) frame.depth.setTo(0);
    result.mask = view.label.clone();
  }
  result.frame = std::make_shared<const RgbdFrame>(std::move(frame));
  return result;
}

Trajectory Simulator::GroundTruth() const {
  Trajectory trajectory;
  const double start_s = parts_->scenario.start_time_s, end_s = TimeOf(num_frames() - 1);
  const int count = static_cast<int>(std::ceil((end_s - start_s) * 100)) + 1;
  for (int i = -1; i <= count; ++i) {
    const double time_s = start_s + 0.01 * i;
    trajectory.push_back({time_s, PoseAt(time_s)});
  }
  return trajectory;
}

}  // namespace msf
