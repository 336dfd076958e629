#include "training/model_config.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <sstream>

#include "util/options.h"

namespace msf {

namespace {

// YOLOv8n's stand-alone stride-2 convolutions: of the backbone, and of backbone and neck.
const std::vector<int> kBackbone = {0, 1, 3, 5, 7};
const std::vector<int> kAll = {0, 1, 3, 5, 7, 16, 19};

bool Contains(const std::vector<int>& layers, int layer) {
  return std::find(layers.begin(), layers.end(), layer) != layers.end();
}

bool IsMsfWidth(double width) { return width > 0.0 && width <= 2.0; }

// Widths by layer.
using MsfWidths = std::map<int, double>;

MsfWidths EachAsWide(const std::vector<int>& layers, double width) {
  MsfWidths widths;
  for (const int layer : layers) widths[layer] = width;
  return widths;
}

// The layers that a placement names; nothing where it is not understood.
std::optional<MsfWidths> ReadPlacement(const std::string& placement, double width) {
  if (placement == "none") return MsfWidths();
  if (placement == "backbone") return EachAsWide(kBackbone, width);
  if (placement == "all") return EachAsWide(kAll, width);
  MsfWidths widths;
  std::istringstream list(placement);
  int layer = 0;
  while (list >> layer) {
    if (!Contains(kAll, layer)) return std::nullopt;
    double& own = widths[layer] = width;
    if (list.peek() == ':' && !(list.ignore() >> own && IsMsfWidth(own))) return std::nullopt;
    if (list.eof() || list.peek() == EOF) return widths;
    if (list.get() != ',') return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace

std::optional<double> ModelConfig::MsfWidthAt(int layer) const {
  const std::optional<MsfWidths> widths = ReadPlacement(msf_placement, msf_width);
  if (!widths || !widths->contains(layer)) return std::nullopt;
  return widths->at(layer);
}

Status ModelConfig::Check() const {
  const auto one_of = [](const std::string& value, const std::vector<std::string>& allowed) {
    return std::find(allowed.begin(), allowed.end(), value) != allowed.end();
  };
  const auto odd = [](int kernel) { return kernel >= 1 && kernel <= 15 && kernel % 2 == 1; };
  if (!ReadPlacement(msf_placement, msf_width)) {
    return Status::Error(
        "msf_placement must be none, backbone, all or a list of stride-2 layers (0, 1, 3, 5, 7, "
        "16, 19) like 3,5, if need be with widths in (0, 2] like 3:1,19:0.75, not '" +
        msf_placement + "'");
  }
  if (!one_of(neck, {"pan", "fpn", "hrnet"}))
    return Status::Error("neck must be pan, fpn or hrnet, not '" + neck + "'");
  if (!IsMsfWidth(msf_width)) return Status::Error("msf_width must lie in (0, 2]");
  if (!odd(msf_standard_kernel) || !std::all_of(msf_kernels.begin(), msf_kernels.end(), odd))
    return Status::Error("the kernels of MSFConv must be odd and between 1 and 15");
  if (classes.empty()) return Status::Error("a model needs at least one class");
  if (class_width < 0) return Status::Error("class_width must not be negative");
  return Status::Ok();
}

StatusOr<ModelConfig> LoadModelConfig(const std::string& name_or_file) {
  ModelConfig config;
  config.name = name_or_file;
  config.classes = VocClasses();
  if (name_or_file == "yolov8n") return config;
  if (name_or_file == "yolov8n_msf") {
    config.msf_placement = "all";
    return config;
  }
  if (name_or_file == "yolov8n_msf_wide") {
    config.msf_placement = "3,5";
    config.msf_width = 0.75;
    return config;
  }
  if (name_or_file == "yolov8n_msf_full") {
    config.msf_placement = "3:1,19:0.8125";
    return config;
  }
  if (name_or_file == "yolov8n_coco") {
    config.classes = CocoClasses();
    return config;
  }
  if (name_or_file == "yolov8n_fpn" || name_or_file == "yolov8n_hrnet") {
    config.neck = name_or_file.substr(8);
    return config;
  }
  if (!std::filesystem::exists(name_or_file)) {
    return Status::Error("there is no model '" + name_or_file +
                         "': use yolov8n, yolov8n_msf, yolov8n_msf_wide, yolov8n_msf_full, "
                         "yolov8n_fpn, yolov8n_hrnet, yolov8n_coco or the path of a YAML file");
  }
  config.name = std::filesystem::path(name_or_file).stem().string();
  MSF_RETURN_IF_ERROR(LoadOptions(name_or_file, config));
  const Status status = config.Check();
  if (!status.ok()) return Status::Error(name_or_file + ": " + status.message());
  return config;
}

}  // namespace msf
