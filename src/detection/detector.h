// Finding objects in images: the interface and its options.
#pragma once

#include <filesystem>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "detection/detection.h"
#include "sensor/rgbd_frame.h"
#include "util/status.h"

namespace msf {

struct DetectorOptions {
  std::string model = "yolov8n_msf_voc.onnx";
  std::string backend = "onednn";
  std::string precision = "auto";
  int width = 0;
  int height = 0;
  double confidence = 0.25;
  double max_iou = 0.7;
  double overlap_decay = 0.5;
  int max_detections = 300;
  bool every_class = false;
  std::string classes;
  int threads = 1;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("model", model, "ONNX file, or the name of one that comes with MSF-SLAM");
    visit("backend", backend, "onednn, or opencv for networks that onednn does not read");
    visit("precision", precision,
          "auto, fp32, bf16 or int8 (a model from 'detector quantize'); auto is the fastest one");
    visit("width", width,
          "input width of the network, pixels, a multiple of 32; 0: the model's own, or 416");
    visit("height", height,
          "input height of the network, pixels, a multiple of 32; 0: the model's own, or 320");
    visit(
        "confidence", confidence,
        "least score of a detection, 0 to 1; in sequences dynamic.tracks and dynamic.class_scores "
        "decide what is done with weaker ones");
    visit("max_iou", max_iou,
          "overlap above which the weaker of two detections of one class is dropped");
    visit("overlap_decay", overlap_decay,
          "other detections that a better one of their class overlaps lose score by exp(-iou^2 / "
          "this); 0: they keep it");
    visit("max_detections", max_detections, "most detections per image");
    visit("every_class", every_class,
          "report a box once for each class that reaches the confidence (evaluation)");
    visit("classes", classes, "file with one class name per line; empty: the names in the model");
    visit("threads", threads,
          "threads of the network; more than one pays only on an otherwise idle machine");
  }
  Status Check() const;
  OverlapRule overlaps() const;
};

// Finds objects in one image at a time. Not to be used by two threads at once.
class Detector {
 public:
  virtual ~Detector() = default;

  // `image`: 8-bit BGR or grey, any size. Boxes in its pixels. `frame` and `time_s` of the result
  // are not set.
  virtual StatusOr<Detections> DetectInImage(const cv::Mat& image) = 0;

  // The same for an image that is upright only after it has been turned by `turn_rad`, clockwise as
  // one looks at it. Boxes are upright boxes in pixels of `image` around what was found
  // (TurnedPicture).
  StatusOr<Detections> DetectTurned(const cv::Mat& image, double turn_rad);

  // The same for the mirror image (left and right exchanged) of the image that was turned. Boxes,
  // too, are those of `image`.
  StatusOr<Detections> DetectMirrored(const cv::Mat& image, double turn_rad);

  // The colour image of a frame, turned if need be; the result carries the frame's id and time.
  StatusOr<Detections> Detect(const RgbdFrame& frame, double turn_rad = 0);

  // Confidence at which DetectInImage reports, 0 to 1.
  virtual void set_confidence(double confidence) = 0;

  const std::vector<std::string>& class_names() const { return class_names_; }
  // Size of the network's input in pixels.
  cv::Size input_size() const { return input_size_; }
  // One line for logs: model, backend, precision, input size.
  const std::string& description() const { return description_; }

 protected:
  Detector(std::vector<std::string> class_names, cv::Size input_size, std::string description)
      : class_names_(std::move(class_names)),
        input_size_(input_size),
        description_(std::move(description)) {}

 private:
  std::vector<std::string> class_names_;
  cv::Size input_size_;
  std::string description_;
};

// Loads the model and prepares it. An error names the file and what to do.
StatusOr<std::unique_ptr<Detector>> MakeDetector(const DetectorOptions& options);

// The path of a model: itself when it is a file; else looked for by name in models/ of the
// DataFolders (util/data_path.h). The error lists these places.
StatusOr<std::filesystem::path> FindModel(const std::string& name);

}  // namespace msf
