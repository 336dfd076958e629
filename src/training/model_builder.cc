#include <algorithm>

#include "training/model_blocks.h"
#include "training/model_config.h"
#include "util/check.h"

namespace msf {

namespace {

// Puts the layers of a YOLOv8n-style detector into a graph.
class DetectorBuilder {
 public:
  explicit DetectorBuilder(const ModelConfig& config) : config_(config), build_(graph_) {
    graph_.name = config.name;
    graph_.classes = config.classes;
  }

  ModelGraph Build() {
    const Pyramid stages = Backbone(build_.Input());
    if (config_.neck == "fpn") {
      Detect(FpnNeck(build_, PanNeck(stages)));
    } else if (config_.neck == "hrnet") {
      Detect(ExchangeNeck(build_, stages, 2));
    } else {
      Detect(PanNeck(stages));
    }
    build_.EndLayer();
    return std::move(graph_);
  }

 private:
  // A stand-alone stride-2 convolution, which is what MSFConv replaces.
  int Down(int input, int channels) {
    const int layer = static_cast<int>(graph_.layers.size());
    const std::optional<double> msf_width = config_.MsfWidthAt(layer);
    if (!msf_width) return ConvLayer(build_, input, channels, 3, 2);
    return MsfConvLayer(build_, input, channels,
                        {*msf_width, config_.msf_kernels, config_.msf_standard_kernel});
  }

  Pyramid Backbone(int image) {
    Pyramid stages{};
    int x = Down(image, 16);
    x = Down(x, 32);
    x = C2fLayer(build_, x, 32, 1, true);
    x = Down(x, 64);
    stages[0] = C2fLayer(build_, x, 64, 2, true);
    x = Down(stages[0], 128);
    stages[1] = C2fLayer(build_, x, 128, 2, true);
    x = Down(stages[1], 256);
    x = C2fLayer(build_, x, 256, 1, true);
    stages[2] = SppfLayer(build_, x, 256);
    return stages;
  }

  // Path aggregation: coarse to fine, then fine to coarse.
  Pyramid PanNeck(const Pyramid& stages) {
    int x = ConcatLayer(build_, {UpsampleLayer(build_, stages[2]), stages[1]});
    const int middle = C2fLayer(build_, x, 128, 1, false);
    x = ConcatLayer(build_, {UpsampleLayer(build_, middle), stages[0]});
    Pyramid out{};
    out[0] = C2fLayer(build_, x, 64, 1, false);
    x = ConcatLayer(build_, {Down(out[0], 64), middle});
    out[1] = C2fLayer(build_, x, 128, 1, false);
    x = ConcatLayer(build_, {Down(out[1], 128), stages[2]});
    out[2] = C2fLayer(build_, x, 256, 1, false);
    return out;
  }

  void Detect(const Pyramid& maps) {
    build_.BeginLayer("Detect");
    const std::string name = build_.LayerName();
    const int classes = static_cast<int>(config_.classes.size());
    const int width =
        config_.class_width > 0 ? config_.class_width : std::max(64, std::min(classes, 100));
    for (size_t i = 0; i < maps.size(); ++i) {
      graph_.box_heads.push_back(
          Head(name + ".cv2." + std::to_string(i), maps[i], 64, 4 * kBoxBins));
      graph_.class_heads.push_back(
          Head(name + ".cv3." + std::to_string(i), maps[i], width, classes));
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
};

}  // namespace

ModelGraph BuildModelGraph(const ModelConfig& config) {
  const Status status = config.Check();
  MSF_CHECK(status.ok(), status.message());
  return DetectorBuilder(config).Build();
}

}  // namespace msf
