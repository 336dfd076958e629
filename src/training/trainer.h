// The training of a detector from start to finish, resumable after every epoch.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "training/augmentation.h"
#include "training/batch.h"
#include "training/model_config.h"
#include "training/network.h"
#include "training/optimizer.h"

namespace msf {

struct TrainOptions {
  int epochs = 4;
  int batch = 8;
  int side = 320;
  double balance = 0.5;
  int mosaic_off_epochs = 1;
  bool bfloat16 = true;
  int64_t seed = 0;
  int threads = 1;
  bool freeze_norms = true;
  int freeze_layers = 3;
  int distill_epochs = 1;
  double distill_rate = 1e-3;
  double new_rate = 1.0;
  double label_weight = 1.0;
  double imitation = 2.0;
  double feature_imitation = 0.0;
  bool imitate_turned = false;
  bool imitate_mirrored = false;
  double average_decay = 0.998;
  double average_ramp = 200.0;
  int validation_images = 100;
  int patience = 0;
  OptimizerOptions optimizer;
  AugmentationOptions augmentation;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("epochs", epochs, "passes over the training images");
    visit("batch", batch, "images per step");
    visit("side", side,
          "training pictures are square with this many pixels a side (a multiple of 32)");
    visit("balance", balance,
          "exponent by which images with rare classes are shown more often; 0: all alike");
    visit("mosaic_off_epochs", mosaic_off_epochs, "last epochs without mosaics");
    visit("bfloat16", bfloat16, "convolutions in bfloat16");
    visit("seed", seed,
          "decides starting weights of new parts, the order of images and all augmentation");
    visit("threads", threads, "threads of libtorch");
    visit("freeze_norms", freeze_norms,
          "keep the batch norms' statistics of the starting weights (after distillation)");
    visit("freeze_layers", freeze_layers,
          "first layers that keep their starting weights (after distillation)");
    visit("distill_epochs", distill_epochs,
          "passes in which new layers learn to reproduce the layers of the starting weights");
    visit("distill_rate", distill_rate, "largest learning rate (AdamW) of those passes");
    visit("new_rate", new_rate,
          "new layers learn this many times as fast as those with starting weights");
    visit("label_weight", label_weight, "weight of the loss on the labels");
    visit(
        "imitation", imitation,
        "weight of the distance to the class logits of the network that gave the starting weights");
    visit("feature_imitation", feature_imitation,
          "weight of the distance to that network's layers on upright pictures");
    visit("imitate_turned", imitate_turned,
          "that distance counts on rotated pictures, too, which that network sees upright");
    visit("imitate_mirrored", imitate_mirrored,
          "the class logits to imitate are the mean over the picture and its mirror image");
    visit("average_decay", average_decay,
          "decay of the moving average of weights that is kept in the end");
    visit("average_ramp", average_ramp, "updates over which that decay rises");
    visit("validation_images", validation_images,
          "training images that are set aside for the curve");
    visit("patience", patience,
          "epochs without a better validation after which the training ends; 0: never");
    visit("optimizer", optimizer, "");
    visit("augmentation", augmentation, "");
  }
  Status Check() const;
};

// One line of the curve.
struct EpochRecord {
  int epoch = 0;
  double learning_rate = 0.0;
  double box_loss = 0.0;
  double class_loss = 0.0;
  double distribution_loss = 0.0;
  double imitation_loss = 0.0;
  double feature_loss = 0.0;
  double map50 = 0.0;
  double map50_95 = 0.0;
};

// Work done so far in one stage of a training.
struct TrainProgress {
  std::string stage;
  int epoch = 0;
  int epochs = 0;
  int step = 0;
  int steps = 0;
  double loss = 0.0;
};

class Trainer {
 public:
  using ProgressCallback = std::function<void(const TrainProgress&)>;

  // `images`: all images, of which `options.validation_images` (chosen by the seed) are set aside.
  Trainer(const ModelConfig& model, const TrainOptions& options, std::vector<LabeledImage> images,
          ProgressCallback on_progress);

  // Starts from the weights of a YOLOv8n-like detector (see AdaptWeights). New layers are distilled
  // from it in Run().
  Status Initialize(const NamedTensors& weights);

  // Goes on from the weights of an earlier training of the very same model instead: nothing is
  // distilled. After Initialize(), whose network remains the teacher.
  Status StartFrom(const NamedTensors& weights);

  // Trains until the end, writing DIR/checkpoint.pt after every epoch, DIR/curves.csv,
  // DIR/curves.svg, and at the end DIR/weights.pt (the moving average). Goes on from
  // DIR/checkpoint.pt where there is one of the same options; the result is then the same as
  // without the interruption.
  Status Run(const std::filesystem::path& directory);

  const std::vector<EpochRecord>& records() const { return records_; }
  // The moving average's weights.
  const NamedTensors& weights() const { return average_->state(); }
  const ModelGraph& graph() const { return network_.graph(); }

 private:
  // Closed-form weights for MSFConv blocks; returns the new tensors that still have something to
  // learn of the teacher's layers. Then layer-wise distillation of these.
  std::vector<std::string> InitializeBlocks();
  void Distill();
  void TrainEpoch(int epoch);
  EpochSampler Sampler(int epoch, double mosaic) const;
  // How far a batch's outputs are from the teacher's; 0 without one.
  struct Distances {
    torch::Tensor classes = torch::zeros({});   // of the class logits
    torch::Tensor features = torch::zeros({});  // of the layers
  };
  // Outputs for a batch, gradients recorded.
  HeadOutputs ForwardForTraining(const Batch& batch, Distances& distances);
  // The distances on the pictures that count for it. `values`: of the network's nodes.
  Distances Imitate(const std::vector<torch::Tensor>& values, const Batch& batch) const;
  std::set<std::string> TrainedParameters() const;
  // Parameters among the tensors, and the norms of convolutions among them.
  std::set<std::string> ParametersOf(const std::vector<std::string>& tensors) const;
  // Loss of one batch after its gradients were added; fills the record's sums.
  double TrainStep(const Batch& batch, EpochRecord& record);
  void ValidateEpoch(EpochRecord& record);
  bool Stalled() const;

  Status SaveCheckpoint(const std::filesystem::path& file) const;
  Status LoadCheckpoint(const std::filesystem::path& file);
  std::string OptionsFingerprint() const;

  TrainOptions options_;
  std::vector<LabeledImage> images_;
  std::vector<LabeledImage> validation_;
  ProgressCallback on_progress_;
  Network network_;
  std::unique_ptr<Network> teacher_;
  std::vector<std::string> new_tensors_;
  std::unique_ptr<Optimizer> optimizer_;
  std::unique_ptr<WeightAverage> average_;
  std::vector<EpochRecord> records_;
};

}  // namespace msf
