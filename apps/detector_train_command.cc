// msf-slam detector train: trains a detector on images in PASCAL VOC layout.
#include <chrono>
#include <iomanip>
#include <iostream>
#include <memory>

#include "apps/command.h"
#include "apps/detector_training.h"
#include "io/voc_dataset.h"
#include "training/batch.h"
#include "training/model_config.h"
#include "training/trainer.h"
#include "util/options.h"

namespace msf {

namespace {

struct TrainArguments {
  std::vector<std::string> data;
  std::string model = "yolov8n";
  std::string init;
  std::string start;
  std::string out;
  std::vector<std::string> settings;
};

// Prints one line about every 20 s: stage, epoch, step, mean loss, time left in the stage.
class ProgressPrinter {
 public:
  void operator()(const TrainProgress& progress) {
    const Clock::time_point now = Clock::now();
    const int64_t done = int64_t{progress.epoch} * progress.steps + progress.step + 1;
    if (progress.stage != stage_) {
      stage_ = progress.stage;
      start_ = now;
      printed_ = now;
      first_ = done - 1;
    }
    sum_ += progress.loss;
    ++count_;
    const bool epoch_ends = progress.step + 1 == progress.steps;
    if (now - printed_ < std::chrono::seconds(20) && !epoch_ends) return;
    const double seconds = std::chrono::duration<double>(now - start_).count();
    const double left = seconds / static_cast<double>(done - first_) *
                        static_cast<double>(int64_t{progress.epochs} * progress.steps - done);
    std::cerr << stage_ << " epoch " << progress.epoch + 1 << "/" << progress.epochs << " step "
              << progress.step + 1 << "/" << progress.steps << " loss " << std::setprecision(4)
              << sum_ / count_ << ", " << std::setprecision(3) << left / 60.0 << " min left"
              << std::endl;
    printed_ = now;
    sum_ = 0.0;
    count_ = 0;
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::string stage_;
  Clock::time_point start_;
  Clock::time_point printed_;
  int64_t first_ = 0;
  double sum_ = 0.0;
  int count_ = 0;
};

void Train(const TrainArguments& arguments) {
  TrainOptions options;
  for (const std::string& setting : arguments.settings) Require(SetOption(setting, options));
  Require(options.Check());
  const ModelConfig model = Require(LoadModelConfig(arguments.model));

  std::vector<LabeledImage> images;
  for (const std::string& root : arguments.data) {
    for (LabeledImage& image : Require(DecodeImages(Require(LoadVocSet(root, model.classes)))))
      images.push_back(std::move(image));
  }
  std::cerr << images.size() << " images\n";
  Trainer trainer(model, options, std::move(images), ProgressPrinter());
  if (!arguments.init.empty()) Require(trainer.Initialize(Require(LoadTensors(arguments.init))));
  if (!arguments.start.empty()) Require(trainer.StartFrom(Require(LoadTensors(arguments.start))));
  Require(trainer.Run(arguments.out));
  if (trainer.records().empty()) return;
  const EpochRecord& last = trainer.records().back();
  std::cout << "epoch " << last.epoch << ": validation mAP50 " << last.map50 << ", mAP50-95 "
            << last.map50_95 << "\n";
}

}  // namespace

void AddDetectorTrainCommand(CLI::App& app) {
  CLI::App* detector = DetectorCommand(app);
  CLI::App* command =
      detector->add_subcommand("train", "Train a detector on images in PASCAL VOC layout");
  const auto arguments = std::make_shared<TrainArguments>();
  command->add_option("--data", arguments->data, "VOC folders, ROOT (its trainval set) or ROOT:SET")
      ->required();
  command->add_option("--model", arguments->model,
                      "yolov8n, yolov8n_msf, yolov8n_msf_wide, yolov8n_msf_full, yolov8n_fpn, "
                      "yolov8n_hrnet or a YAML file");
  command->add_option(
      "--init", arguments->init,
      "weights to start from (YOLOv8n of 80 COCO classes, or of an earlier training), as .pt or as "
      "an ONNX file that was exported here");
  command->add_option(
      "--start", arguments->start,
      "weights.pt or ONNX file of an earlier training of this model to go on from, instead of "
      "distillation; --init still names the teacher");
  command
      ->add_option(
          "--out", arguments->out,
          "folder for checkpoint, weights and curves; an unfinished training there goes on")
      ->required();
  command->add_option(
      "--set", arguments->settings,
      "option=value, e.g. epochs=20 or augmentation.mosaic=0\n" + DescribeOptions<TrainOptions>());
  command->callback([arguments] { Train(*arguments); });
}

}  // namespace msf
