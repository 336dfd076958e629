#include "detection/opencv_detector.h"

#include <fmt/format.h>

#include <opencv2/dnn.hpp>

#include "detection/head_decoder.h"
#include "detection/letterbox.h"
#include "detection/onednn_detector.h"
#include "detection/onnx_editor.h"
#include "detection/onnx_reader.h"

namespace msf {
namespace {

// Views of OpenCV's results; they live as long as `results`.
std::vector<NetworkOutput> Views(const std::vector<cv::Mat>& results,
                                 const std::vector<std::string>& names) {
  std::vector<NetworkOutput> views;
  for (size_t i = 0; i < results.size(); ++i) {
    NetworkOutput view;
    view.name = names[i];
    for (int d = 0; d < results[i].dims; ++d) view.shape.push_back(results[i].size[d]);
    view.data = results[i].ptr<float>();
    views.push_back(view);
  }
  return views;
}

class OpenCvDetector : public Detector {
 public:
  OpenCvDetector(std::vector<std::string> class_names, cv::Size input_size, std::string description,
                 const DetectorOptions& options, const cv::dnn::Net& net, HeadDecoder decoder)
      : Detector(std::move(class_names), input_size, std::move(description)),
        options_(options),
        net_(net),
        output_names_(net_.getUnconnectedOutLayersNames()),
        decoder_(std::move(decoder)),
        pixels_(input_size, CV_8UC3) {}

  StatusOr<Detections> DetectInImage(const cv::Mat& image) override {
    MSF_RETURN_IF_ERROR(CheckImage(image));
    const Letterbox letterbox(image.size(), input_size());
    letterbox.Fill(image, pixels_.data);
    std::vector<cv::Mat> results;
    try {
      net_.setInput(cv::dnn::blobFromImage(pixels_, 1.0 / 255.0));
      net_.forward(results, output_names_);
    } catch (const cv::Exception& error) {
      return Status::Error("OpenCV could not run the detector: " + error.err);
    }
    std::vector<Detection> found =
        decoder_.Decode(Views(results, output_names_), static_cast<float>(options_.confidence),
                        options_.every_class);
    Detections detections;
    detections.objects = SuppressOverlaps(std::move(found), options_.overlaps());
    for (Detection& object : detections.objects) object.box = letterbox.ToImage(object.box);
    return detections;
  }

  void set_confidence(double confidence) override { options_.confidence = confidence; }

 private:
  DetectorOptions options_;
  cv::dnn::Net net_;
  std::vector<std::string> output_names_;
  HeadDecoder decoder_;
  cv::Mat pixels_;
};

}  // namespace

StatusOr<std::unique_ptr<Detector>> MakeOpenCvDetector(const DetectorOptions& options,
                                                       const std::filesystem::path& model) {
  if (options.precision != "auto" && options.precision != "fp32") {
    return Status::Error("the opencv backend computes in fp32 only, not in " + options.precision);
  }
  StatusOr<std::string> bytes = ReadModelBytes(model);
  if (!bytes.ok()) return bytes.status();
  // Only size and names are wanted here: a network that our reader does not know may still run in
  // OpenCV.
  StatusOr<Graph> graph = ParseOnnx(*bytes, model.string());
  Graph described;
  described.source = model.string();
  described.AddValue("images");
  described.inputs = {0};
  if (graph.ok()) described = *std::move(graph);
  StatusOr<cv::Size> size = InputSizeFor(options, described);
  if (!size.ok()) return size.status();
  StatusOr<std::string> simple = SimplifyOnnx(*bytes, size->height, size->width);
  if (!simple.ok()) return Status::Error(model.string() + ": " + simple.message());
  try {
    cv::dnn::Net net = cv::dnn::readNetFromONNX(simple->data(), simple->size());
    net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    std::vector<cv::Mat> results;
    const cv::Mat grey(*size, CV_8UC3, cv::Scalar::all(114));
    net.setInput(cv::dnn::blobFromImage(grey, 1.0 / 255.0));
    const std::vector<std::string> names = net.getUnconnectedOutLayersNames();
    net.forward(results, names);
    StatusOr<HeadDecoder> decoder = HeadDecoder::Make(Views(results, names), model.string());
    if (!decoder.ok()) return decoder.status();
    auto class_names = ClassNamesFor(options, described, decoder->num_classes());
    if (!class_names.ok()) return class_names.status();
    const std::string description = fmt::format(
        "{} on OpenCV, fp32, {}x{}", model.filename().string(), size->width, size->height);
    return std::unique_ptr<Detector>(std::make_unique<OpenCvDetector>(
        *std::move(class_names), *size, description, options, std::move(net), *std::move(decoder)));
  } catch (const cv::Exception& error) {
    return Status::Error(model.string() + ": OpenCV cannot read or run this network: " + error.err);
  }
}

}  // namespace msf
