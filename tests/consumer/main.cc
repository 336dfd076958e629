// The library's face as another project sees it: options in, frames in, poses out.
#include <cstdio>
#include <memory>
#include <opencv2/core.hpp>

#include "system/system.h"

namespace {

// Counts the frames it hears of.
class Counter : public msf::Observer {
 public:
  void OnFrame(const msf::TrackingResult&) override { ++num_frames; }
  int num_frames = 0;
};

// A wall full of random boxes, two metres away.
msf::RgbdFramePtr MakeFrame(int index, const std::shared_ptr<const msf::Camera>& camera) {
  cv::Mat small(camera->height / 16, camera->width / 16, CV_8UC1);
  cv::RNG(7).fill(small, cv::RNG::UNIFORM, 0, 255);
  auto frame = std::make_shared<msf::RgbdFrame>();
  frame->id = msf::FrameId(index);
  frame->time_s = index / camera->fps;
  frame->camera = camera;
  frame->color.create(camera->height, camera->width, CV_8UC1);
  for (int y = 0; y < camera->height; ++y) {
    for (int x = 0; x < camera->width; ++x)
      frame->color.at<uchar>(y, x) = small.at<uchar>(y / 16, x / 16);
  }
  frame->depth =
      cv::Mat(camera->height, camera->width, CV_16UC1, cv::Scalar(2 * camera->depth_factor));
  return frame;
}

int Fail(const std::string& why) {
  std::fprintf(stderr, "consumer: %s\n", why.c_str());
  return 1;
}

}  // namespace

int main() {
  const auto camera = std::make_shared<const msf::Camera>(*msf::Camera::Preset("simulated"));
  msf::SystemOptions options;
  options.deterministic = true;
  msf::StatusOr<std::unique_ptr<msf::System>> system = msf::System::Create(options, *camera);
  if (!system.ok()) return Fail(system.message());
  const auto counter = std::make_shared<Counter>();
  (*system)->AddObserver(counter);

  constexpr int kFrames = 5;
  for (int i = 0; i < kFrames; ++i) {
    const msf::StatusOr<msf::TrackingResult> result = (*system)->Track(MakeFrame(i, camera));
    if (!result.ok()) return Fail(result.message());
    if (!result->T_cw) return Fail("frame " + std::to_string(i) + " has no pose");
    // Nothing moves, so neither does the camera.
    if (result->T_cw->translation().norm() > 1e-3) return Fail("the camera moved");
  }
  const msf::Reconstruction reconstruction = (*system)->Finish();
  if (reconstruction.frames.size() != kFrames || counter->num_frames != kFrames)
    return Fail("frames were lost");
  if (reconstruction.points.empty()) return Fail("the map is empty");
  std::printf("consumer: %zu frames, %zu points\n", reconstruction.frames.size(),
              reconstruction.points.size());
  return 0;
}
