#include "sensor/rgbd_frame.h"

#include <fmt/format.h>

namespace msf {

Status CheckFrame(const RgbdFrame& frame) {
  MSF_CHECK(frame.camera != nullptr, "a frame needs its camera");
  const Camera& camera = *frame.camera;
  const cv::Size size(camera.width, camera.height);
  if (frame.color.size() != size || frame.depth.size() != size) {
    return Status::Error(fmt::format("colour is {}x{} and depth {}x{} where the camera says {}x{}",
                                     frame.color.cols, frame.color.rows, frame.depth.cols,
                                     frame.depth.rows, size.width, size.height));
  }
  if (frame.color.type() != CV_8UC3 && frame.color.type() != CV_8UC1) {
    return Status::Error("the colour image must have 8 bits per channel and 1 or 3 channels");
  }
  if (frame.depth.type() != CV_16UC1)
    return Status::Error("the depth image must have one channel of 16 bits");
  return Status::Ok();
}

}  // namespace msf
