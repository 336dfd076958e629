#include "training/model_config.h"

#include <algorithm>
#include <filesystem>

#include "util/check.h"
#include "util/options.h"

namespace msf {

Status ModelConfig::Check() const {
  const auto one_of = [](const std::string& value, const std::vector<std::string>& allowed) {
    return std::find(allowed.begin(), allowed.end(), value) != allowed.end();
  };
  const auto odd = [](int kernel) { return kernel >= 1 && kernel <= 15 && kernel % 2 == 1; };
  if (!one_of(msf_placement, {"none", "backbone", "all"}))
    return Status::Error("msf_placement must be none, backbone or all, not '" + msf_placement + "'");
  if (!one_of(neck, {"pan", "fpn", "hrnet"})) return Status::Error("neck must be pan, fpn or hrnet, not '" + neck + "'");
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
                         "': use yolov8n, yolov8n_msf, yolov8n_fpn, yolov8n_hrnet, yolov8n_coco or the path of a YAML file");
  }
  config.name = std::filesystem::path(name_or_file).stem().string();
  MSF_RETURN_IF_ERROR(LoadOptions(name_or_file, config));
  const Status status = config.Check();
  if (!status.ok()) return Status::Error(name_or_file + ": " + status.message());
  return config;
}

namespace {

// Puts the layers of a YOLOv8n-style detector into a graph.
class DetectorBuilder {
 public:
  explicit DetectorBuilder(const ModelConfig& config) : config_(config), build_(graph_) {
    graph_.name = config.name;
    graph_.classes = config.classes;
  }

  ModelGraph Build() {
    const int image = build_.Input();
    Backbone(image);
    PanNeck();
    build_.EndLayer();
    return std::move(graph_);
  }

 private:
  std::string Name() const { return "model." + std::to_string(graph_.layers.size() - 1); }
  int Last() const { return static_cast<int>(graph_.nodes.size()) - 1; }
  bool Placed(bool backbone) const {
    return config_.msf_placement == "all" || (config_.msf_placement == "backbone" && backbone);
  }

  // A stand-alone stride-2 convolution, which is what MSFConv replaces.
  int Down(int input, int channels, bool backbone) {
    if (Placed(backbone)) return MsfConv(input, channels);
    build_.BeginLayer("Conv");
    return build_.Conv(Name(), input, channels, 3, 2);
  }

  int MsfConv(int input, int channels) {
    build_.BeginLayer("MSFConv");
    const std::string name = Name();
    const int width = std::max(1, static_cast<int>(channels * config_.msf_width));
    const int conv = build_.Conv(name + ".cv1", input, width, 3, 2);
    std::vector<int> branches;
    for (size_t i = 0; i < config_.msf_kernels.size(); ++i) {
      branches.push_back(DepthwiseBranch(name + ".dw" + std::to_string(i), conv, config_.msf_kernels[i]));
    }
    branches.insert(branches.begin() + std::min<size_t>(1, branches.size()),
                    build_.RawConv({.name = name + ".std", .channels = width, .kernel = config_.msf_standard_kernel, .normalized = true}, conv));
    if (build_.node(input).channels == width) {
      const int residual = build_.AveragePool(input, 2);
      for (int& branch : branches) branch = build_.Add(branch, residual);
    }
    const int activated = build_.Norm(name + ".norm", build_.Concat(branches));
    return build_.RawConv({.name = name + ".cv2", .channels = channels}, activated);
  }

  int DepthwiseBranch(const std::string& name, int input, int kernel) {
    const int width = build_.node(input).channels;
    const int depthwise = build_.RawConv({.name = name + ".dw", .channels = width, .kernel = kernel, .groups = width}, input);
    return build_.RawConv({.name = name + ".pw", .channels = width, .normalized = true}, depthwise);
  }

  int C2f(int input, int channels, int repeats, bool shortcut) {
    build_.BeginLayer("C2f");
    const std::string name = Name();
    const int half = channels / 2;
    const int both = build_.Conv(name + ".cv1", input, 2 * half);
    std::vector<int> pieces = {build_.Slice(both, 0, half), build_.Slice(both, half, half)};
    for (int i = 0; i < repeats; ++i) {
      const std::string inner = name + ".m." + std::to_string(i);
      const int first = build_.Conv(inner + ".cv1", pieces.back(), half, 3);
      const int second = build_.Conv(inner + ".cv2", first, half, 3);
      pieces.push_back(shortcut ? build_.Add(pieces.back(), second) : second);
    }
    return build_.Conv(name + ".cv2", build_.Concat(pieces), channels);
  }

  int Sppf(int input, int channels) {
    build_.BeginLayer("SPPF");
    const std::string name = Name();
    std::vector<int> pieces = {build_.Conv(name + ".cv1", input, channels / 2)};
    for (int i = 0; i < 3; ++i) pieces.push_back(build_.MaxPool(pieces.back(), 5, 1));
    return build_.Conv(name + ".cv2", build_.Concat(pieces), channels);
  }

  int Upsample(int input) {
    build_.BeginLayer("Upsample");
    return build_.Upsample(input);
  }

  int Concat(const std::vector<int>& inputs) {
    build_.BeginLayer("Concat");
    return build_.Concat(inputs);
  }

  void Backbone(int image) {
    int x = Down(image, 16, true);
    x = Down(x, 32, true);
    x = C2f(x, 32, 1, true);
    x = Down(x, 64, true);
    p3_ = C2f(x, 64, 2, true);
    x = Down(p3_, 128, true);
    p4_ = C2f(x, 128, 2, true);
    x = Down(p4_, 256, true);
    x = C2f(x, 256, 1, true);
    p5_ = Sppf(x, 256);
  }

  void PanNeck() {
    int x = Concat({Upsample(p5_), p4_});
    const int n4 = C2f(x, 128, 1, false);
    x = Concat({Upsample(n4), p3_});
    const int out3 = C2f(x, 64, 1, false);
    x = Concat({Down(out3, 64, false), n4});
    const int out4 = C2f(x, 128, 1, false);
    x = Concat({Down(out4, 128, false), p5_});
    const int out5 = C2f(x, 256, 1, false);
    Detect({out3, out4, out5});
  }

  void Detect(const std::vector<int>& inputs) {
    build_.BeginLayer("Detect");
    const int classes = static_cast<int>(config_.classes.size());
    const int width = config_.class_width > 0 ? config_.class_width : std::max(64, std::min(classes, 100));
    for (size_t i = 0; i < inputs.size(); ++i) {
      graph_.box_heads.push_back(Head(Name() + ".cv2." + std::to_string(i), inputs[i], 64, 4 * kBoxBins));
      graph_.class_heads.push_back(Head(Name() + ".cv3." + std::to_string(i), inputs[i], width, classes));
    }
  }

  int Head(const std::string& name, int input, int width, int channels) {
    const int first = build_.Conv(name + ".0", input, width, 3);
    const int second = build_.Conv(name + ".1", first, width, 3);
    return build_.RawConv({.name = name + ".2", .channels = channels, .bias = true}, second);
  }

  const ModelConfig& config_;
  ModelGraph graph_;
  GraphBuilder build_;
  int p3_ = 0;
  int p4_ = 0;
  int p5_ = 0;
};

}  // namespace

ModelGraph BuildModelGraph(const ModelConfig& config) {
  const Status status = config.Check();
  MSF_CHECK(status.ok(), status.message());
  return DetectorBuilder(config).Build();
}

}  // namespace msf
