#include "detection/detector.h"

#include <fmt/format.h>

#include <opencv2/core.hpp>

#include "detection/onednn_detector.h"
#include "detection/opencv_detector.h"
#include "detection/turned_picture.h"

namespace msf {

Status DetectorOptions::Check() const {
  const auto size_ok = [](int size) { return size >= 0 && size <= 4096 && size % 32 == 0; };
  if (!size_ok(width) || !size_ok(height)) {
    return Status::Error(fmt::format(
        "the detector's input of {}x{} is not a multiple of 32 up to 4096", width, height));
  }
  if ((width == 0) != (height == 0))
    return Status::Error("give both width and height of the detector's input, or neither");
  if (backend != "onednn" && backend != "opencv") {
    return Status::Error("detector backend '" + backend + "' is not known; use onednn or opencv");
  }
  if (precision != "auto" && precision != "fp32" && precision != "bf16" && precision != "int8") {
    return Status::Error("detector precision '" + precision +
                         "' is not known; use auto, fp32, bf16 or int8");
  }
  if (!(confidence > 0 && confidence < 1))
    return Status::Error("the detector's confidence must lie between 0 and 1");
  if (!(max_iou > 0 && max_iou <= 1))
    return Status::Error("the detector's max_iou must lie between 0 and 1");
  if (!(overlap_decay >= 0))
    return Status::Error("the detector's overlap_decay must not be negative");
  if (max_detections < 1) return Status::Error("the detector's max_detections must be at least 1");
  if (threads < 1 || threads > 256)
    return Status::Error(fmt::format("the detector's threads must be 1 to 256, not {}", threads));
  return Status::Ok();
}

OverlapRule DetectorOptions::overlaps() const {
  return {static_cast<float>(max_iou), static_cast<float>(overlap_decay),
          static_cast<float>(confidence), static_cast<size_t>(max_detections)};
}

StatusOr<Detections> Detector::DetectTurned(const cv::Mat& image, double turn_rad) {
  if (turn_rad == 0) return DetectInImage(image);
  if (image.empty()) return Status::Error("the image for the detector is empty");
  const TurnedPicture turned(image, turn_rad, input_size());
  StatusOr<Detections> detections = DetectInImage(turned.pixels());
  if (!detections.ok()) return detections;
  for (Detection& object : detections->objects) object.box = turned.ToImage(object.box);
  std::erase_if(detections->objects, [](const Detection& d) { return d.box.area() <= 0; });
  return detections;
}

StatusOr<Detections> Detector::DetectMirrored(const cv::Mat& image, double turn_rad) {
  if (image.empty()) return Status::Error("the image for the detector is empty");
  cv::Mat mirrored;
  cv::flip(image, mirrored, 1);
  StatusOr<Detections> detections = DetectTurned(mirrored, -turn_rad);
  if (!detections.ok()) return detections;
  const auto width = static_cast<float>(image.cols);
  for (Detection& object : detections->objects) {
    const ImageBox& box = object.box;
    object.box = {width - box.x1, box.y0, width - box.x0, box.y1};
  }
  return detections;
}

StatusOr<Detections> Detector::Detect(const RgbdFrame& frame, double turn_rad) {
  StatusOr<Detections> detections = DetectTurned(frame.color, turn_rad);
  if (!detections.ok()) return detections;
  detections->frame = frame.id;
  detections->time_s = frame.time_s;
  return detections;
}

StatusOr<std::unique_ptr<Detector>> MakeDetector(const DetectorOptions& options) {
  MSF_RETURN_IF_ERROR(options.Check());
  StatusOr<std::filesystem::path> model = FindModel(options.model);
  if (!model.ok()) return model.status();
  return options.backend == "opencv" ? MakeOpenCvDetector(options, *model)
                                     : MakeOneDnnDetector(options, *model);
}

}  // namespace msf
