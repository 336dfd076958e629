// msf-slam detector export: weights of a training as an ONNX file.
#include <filesystem>
#include <iostream>
#include <memory>

#include "apps/command.h"
#include "apps/detector_training.h"
#include "training/model_config.h"
#include "training/onnx_export.h"
#include "training/weight_adaptation.h"

namespace msf {

namespace {

struct ExportArguments {
  std::string model = "yolov8n";
  std::string weights;
  std::string out;
  std::string blend;
  double blend_share = 0.5;
  bool single_output = false;
  bool full_precision = false;
  int width = 640;
  int height = 640;
};

Status WriteOnnx(const Network& network, const ExportArguments& arguments) {
  OnnxOptions options;
  options.form = arguments.single_output ? OnnxForm::kSingleOutput : OnnxForm::kRawHeads;
  options.width = arguments.width;
  options.height = arguments.height;
  options.half = !arguments.full_precision;
  return ExportOnnx(network.graph(), network.State(), options, arguments.out);
}

void Export(const ExportArguments& arguments) {
  const ModelConfig config = Require(LoadModelConfig(arguments.model));
  NamedTensors weights = Require(LoadTensors(arguments.weights));
  if (!arguments.blend.empty()) {
    weights = Require(
        BlendWeights(weights, Require(LoadTensors(arguments.blend)), arguments.blend_share));
  }
  Network network(BuildModelGraph(config), 0);
  Require(network.Load(Require(AdaptWeights(weights, network.graph()))));
  if (std::filesystem::path(arguments.out).extension() == ".pt") {
    Require(SaveTensors(arguments.out, network.State()));
  } else {
    Require(WriteOnnx(network, arguments));
  }
  std::cout << arguments.out << ": " << config.classes.size() << " classes, "
            << CountParameters(network.graph()) << " parameters\n";
}

}  // namespace

void AddDetectorExportCommand(CLI::App& app) {
  CLI::App* command =
      DetectorCommand(app)->add_subcommand("export", "Write trained weights as an ONNX file");
  const auto arguments = std::make_shared<ExportArguments>();
  command->add_option("--model", arguments->model,
                      "yolov8n, yolov8n_msf, yolov8n_msf_wide, yolov8n_msf_full, yolov8n_fpn, "
                      "yolov8n_hrnet, yolov8n_coco or a YAML file");
  command
      ->add_option("--weights", arguments->weights,
                   "weights.pt of a training, an ONNX file exported here, or COCO weights")
      ->required();
  command
      ->add_option(
          "--out", arguments->out,
          "ONNX file to write; a name that ends in .pt: the (blended) weights, to start another "
          "training from")
      ->required();
  command->add_option("--blend", arguments->blend,
                      "weights.pt that the training started from: keeps more of what they could do "
                      "that the training pictures do not show");
  command
      ->add_option("--blend-share", arguments->blend_share,
                   "share of --blend in the mean of the two")
      ->check(CLI::Range(0.0, 1.0));
  command->add_flag("--single-output", arguments->single_output,
                    "one output with decoded boxes, as common tools use, for one input size; else "
                    "raw heads for any size");
  command->add_option("--width", arguments->width, "input width of the single-output form");
  command->add_option("--height", arguments->height, "input height of the single-output form");
  command->add_flag("--full-precision", arguments->full_precision,
                    "store weights as float32 instead of float16");
  command->callback([arguments] { Export(*arguments); });
}

}  // namespace msf
