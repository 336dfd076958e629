#include "detection/onednn_detector.h"

#include <fmt/format.h>

#include "detection/class_names.h"
#include "detection/compiled_network.h"
#include "detection/dnnl_steps.h"
#include "detection/head_decoder.h"
#include "detection/letterbox.h"
#include "detection/onnx_reader.h"
#include "detection/specialize.h"

namespace msf {
namespace {

class OneDnnDetector : public Detector {
 public:
  OneDnnDetector(std::vector<std::string> class_names, cv::Size input_size, std::string description,
                 const DetectorOptions& options, std::unique_ptr<CompiledNetwork> network,
                 HeadDecoder decoder)
      : Detector(std::move(class_names), input_size, std::move(description)),
        options_(options),
        network_(std::move(network)),
        decoder_(std::move(decoder)) {}

  StatusOr<Detections> DetectInImage(const cv::Mat& image) override {
    MSF_RETURN_IF_ERROR(CheckImage(image));
    const Letterbox letterbox(image.size(), input_size());
    letterbox.Fill(image, network_->pixels());
    MSF_RETURN_IF_ERROR(network_->Run());
    const float confidence = static_cast<float>(options_.confidence);
    std::vector<Detection> found =
        decoder_.Decode(network_->outputs(), confidence, options_.every_class);
    Detections result;
    result.objects = SuppressOverlaps(std::move(found), options_.overlaps());
    for (Detection& object : result.objects) object.box = letterbox.ToImage(object.box);
    return result;
  }

  void set_confidence(double confidence) override { options_.confidence = confidence; }

 private:
  DetectorOptions options_;
  std::unique_ptr<CompiledNetwork> network_;
  HeadDecoder decoder_;
};

const char* Name(NetworkPrecision precision) {
  switch (precision) {
    case NetworkPrecision::kFloat32:
      return "fp32";
    case NetworkPrecision::kBfloat16:
      return "bf16";
    case NetworkPrecision::kInt8:
      return "int8";
  }
  return "";
}

}  // namespace

NetworkPrecision ChoosePrecision(const std::string& name, const Graph& graph) {
  if (name == "fp32") return NetworkPrecision::kFloat32;
  if (name == "bf16") return NetworkPrecision::kBfloat16;
  if (name == "int8") return NetworkPrecision::kInt8;
  if (graph.metadata.count(kActivationRangesKey) > 0) return NetworkPrecision::kInt8;
  return HasFastBfloat16() ? NetworkPrecision::kBfloat16 : NetworkPrecision::kFloat32;
}

StatusOr<std::vector<std::string>> ClassNamesFor(const DetectorOptions& options, const Graph& graph,
                                                 int num_classes) {
  std::vector<std::string> names;
  std::string origin = graph.source;
  if (!options.classes.empty()) {
    origin = options.classes;
    StatusOr<std::vector<std::string>> read = ReadClassNames(options.classes);
    if (!read.ok()) return read;
    names = *read;
  } else if (const auto found = graph.metadata.find("names"); found != graph.metadata.end()) {
    StatusOr<std::vector<std::string>> parsed = ParseClassNames(found->second);
    if (!parsed.ok()) return Status::Error(graph.source + ": " + parsed.message());
    names = *parsed;
  } else {
    for (int i = 0; i < num_classes; ++i) names.push_back(fmt::format("class {}", i));
  }
  if (static_cast<int>(names.size()) != num_classes) {
    return Status::Error(fmt::format("{}: the network has {} classes but {} lists {} names",
                                     graph.source, num_classes, origin, names.size()));
  }
  return names;
}

StatusOr<cv::Size> InputSizeFor(const DetectorOptions& options, const Graph& graph) {
  StatusOr<InputSize> own = DeclaredInputSize(graph);
  if (!own.ok()) return own.status();
  if (options.width > 0) return cv::Size(options.width, options.height);
  return cv::Size(own->width > 0 ? static_cast<int>(own->width) : 416,
                  own->height > 0 ? static_cast<int>(own->height) : 320);
}

Status CheckImage(const cv::Mat& image) {
  if (image.empty()) return Status::Error("the image for the detector is empty");
  if (image.type() == CV_8UC1 || image.type() == CV_8UC3) return Status::Ok();
  return Status::Error("the detector needs 8-bit grey or BGR images");
}

StatusOr<std::unique_ptr<Detector>> MakeOneDnnDetector(const DetectorOptions& options,
                                                       const Graph& graph,
                                                       NetworkPrecision precision) {
  if (precision == NetworkPrecision::kBfloat16 && !HasBfloat16()) {
    return Status::Error(
        "this processor cannot compute in bf16, which takes AVX-512; use precision auto or fp32");
  }
  StatusOr<cv::Size> size = InputSizeFor(options, graph);
  if (!size.ok()) return size.status();
  CompileOptions compile;
  compile.height = size->height;
  compile.width = size->width;
  compile.precision = precision;
  compile.threads = options.threads;
  auto network = CompiledNetwork::Compile(graph, compile);
  if (!network.ok()) return network.status();
  StatusOr<HeadDecoder> decoder = HeadDecoder::Make((*network)->outputs(), graph.source);
  if (!decoder.ok()) return decoder.status();
  auto names = ClassNamesFor(options, graph, decoder->num_classes());
  if (!names.ok()) return names.status();
  const std::string description = fmt::format(
      "{} on oneDNN, {}, {}x{}", std::filesystem::path(graph.source).filename().string(),
      Name(precision), size->width, size->height);
  return std::unique_ptr<Detector>(std::make_unique<OneDnnDetector>(
      *std::move(names), *size, description, options, *std::move(network), *std::move(decoder)));
}

StatusOr<std::unique_ptr<Detector>> MakeOneDnnDetector(const DetectorOptions& options,
                                                       const std::filesystem::path& model) {
  StatusOr<Graph> graph = ReadOnnx(model);
  if (!graph.ok()) return graph.status();
  return MakeOneDnnDetector(options, *graph, ChoosePrecision(options.precision, *graph));
}

}  // namespace msf
