// Live use of the library: options in, frames in, poses out. Put your driver in the place of
// Grab().
#include <cstdio>
#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "system/system.h"

namespace {

// Hears of every frame; viewers and loggers are made like this. Calls come from the system's
// threads, so they should be short.
class Counter : public msf::Observer {
 public:
  void OnFrame(const msf::TrackingResult& /*result*/) override { ++num_frames; }
  int num_frames = 0;
};

// Stands in for the driver of a depth camera: a wall full of random boxes, two metres away. A
// driver that uses its buffers again hands over clones.
bool Grab(const msf::Camera& camera, int index, cv::Mat& color, cv::Mat& depth, double& time_s) {
  constexpr int kFrames = 5, kBox_px = 16;
  if (index == kFrames) return false;
  cv::Mat boxes(camera.height / kBox_px, camera.width / kBox_px, CV_8UC1);
  cv::RNG(7).fill(boxes, cv::RNG::UNIFORM, 0, 255);
  color = cv::Mat(camera.height, camera.width, CV_8UC1);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x)
      color.at<uchar>(y, x) = boxes.at<uchar>(y / kBox_px, x / kBox_px);
  }
  depth = cv::Mat(camera.height, camera.width, CV_16UC1, cv::Scalar(2 * camera.depth_factor));
  time_s = index / camera.fps;
  return true;
}

int Fail(const std::string& why) {
  std::fprintf(stderr, "live: %s\n", why.c_str());
  return 1;
}

}  // namespace

int main() {
  // Or your own: msf::LoadOptions("camera.yaml", camera) of util/options.h.
  const auto camera = std::make_shared<const msf::Camera>(*msf::Camera::Preset("simulated"));
  msf::StatusOr<std::unique_ptr<msf::System>> system =
      msf::System::Create(msf::SystemOptions{}, *camera);
  if (!system.ok()) return Fail(system.message());
  const auto counter = std::make_shared<Counter>();
  (*system)->AddObserver(counter);

  cv::Mat color, depth;
  double time_s = 0;
  int index = 0;
  for (; Grab(*camera, index, color, depth, time_s); ++index) {
    const auto frame = std::make_shared<msf::RgbdFrame>();
    frame->id = msf::FrameId(index);
    frame->time_s = time_s;
    frame->camera = camera;
    frame->color = color.clone();
    frame->depth = depth.clone();
    const msf::StatusOr<msf::TrackingResult> result = (*system)->Track(frame);
    if (!result.ok()) return Fail(result.message());
    if (!result->T_cw) return Fail("frame " + std::to_string(index) + " has no pose");
    // T_cw takes the world to the camera; where the camera is says its inverse.
    const Eigen::Vector3d position_m = result->T_cw->Inverse().translation();
    if (position_m.norm() > 1e-3) return Fail("the camera moved before a wall that stands still");
  }

  const msf::Reconstruction reconstruction = (*system)->Finish();
  if (!reconstruction.health.ok()) return Fail(reconstruction.health.message());
  if (static_cast<int>(reconstruction.frames.size()) != index || counter->num_frames != index)
    return Fail("frames were lost");
  if (reconstruction.points.empty()) return Fail("the map is empty");
  std::printf("live: %zu frames, %zu points\n", reconstruction.frames.size(),
              reconstruction.points.size());
  return 0;
}
