#include "training/model_config.h"

#include <algorithm>
#include <filesystem>

#include "util/options.h"

namespace msf {

Status ModelConfig::Check() const {
  const auto one_of = [](const std::string& value, const std::vector<std::string>& allowed) {
    return std::find(allowed.begin(), allowed.end(), value) != allowed.end();
  };
  const auto odd = [](int kernel) { return kernel >= 1 && kernel <= 15 && kernel % 2 == 1; };
  if (!one_of(msf_placement, {"none", "backbone", "all"}))
    return Status::Error("msf_placement must be none, backbone or all, not '" + msf_placement +
                         "'");
  if (!one_of(neck, {"pan", "fpn", "hrnet"}))
    return Status::Error("neck must be pan, fpn or hrnet, not '" + neck + "'");
  if (!(msf_width > 0.0 && msf_width <= 2.0)) return Status::Error("msf_width must lie in (0, 2]");
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
                         "': use yolov8n, yolov8n_msf, yolov8n_fpn, yolov8n_hrnet, yolov8n_coco or "
                         "the path of a YAML file");
  }
  config.name = std::filesystem::path(name_or_file).stem().string();
  MSF_RETURN_IF_ERROR(LoadOptions(name_or_file, config));
  const Status status = config.Check();
  if (!status.ok()) return Status::Error(name_or_file + ": " + status.message());
  return config;
}

}  // namespace msf
