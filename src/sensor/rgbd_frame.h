// One shot of a depth camera.
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>

#include "sensor/camera.h"
#include "util/strong_id.h"

namespace msf {

// Colour and registered depth at one time. Shared and never changed once made; the images are not
// copied, so a driver that uses its buffers again hands over clones.
struct RgbdFrame {
  FrameId id;         // rises from frame to frame: detections find their image by it
  double time_s = 0;  // of the colour image: the frame's time
  // Time of the depth image minus time_s. Many depth cameras take the two images up to half a frame
  // apart; while the camera turns, depth then belongs to pixels some way off, which the system
  // makes up for.
  double depth_delay_s = 0;
  cv::Mat color;  // camera.height x camera.width, 8-bit BGR (3 channels) or grey (1 channel)
  cv::Mat depth;  // same size, 16-bit, value / camera.depth_factor = metres, 0 = none
  std::shared_ptr<const Camera> camera;
};

using RgbdFramePtr = std::shared_ptr<const RgbdFrame>;

// A sentence when the images do not have the sizes and types that the struct promises.
Status CheckFrame(const RgbdFrame& frame);

}  // namespace msf
