#include "training/trainer.h"

#include <torch/types.h>
#include <torch/utils.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "training/curves.h"
#include "training/detection_loss.h"
#include "training/distillation.h"
#include "training/head_decoding.h"
#include "training/mixed_precision.h"
#include "training/msf_initialization.h"
#include "training/turning.h"
#include "training/validation.h"
#include "training/weight_adaptation.h"

namespace msf {

namespace {

constexpr double kUpright = 0.175;       // rad, 10 degrees: up to here a picture counts as upright
constexpr double kGrey = 114.0 / 255.0;  // of borders, as in MakeTrainingPicture
// Relative error of a block that already computes what the teacher's layer does.
constexpr double kNothingToLearn = 1e-6;

ModelConfig TeacherConfig(const std::vector<std::string>& classes, int class_width) {
  ModelConfig config;
  config.name = "teacher";
  config.classes = classes;
  config.class_width = class_width;
  return config;
}

// Moves `count` images, chosen by the seed, out of `images`.
std::vector<LabeledImage> SetAside(std::vector<LabeledImage>& images, int count, uint64_t seed) {
  Random random(seed);
  std::vector<LabeledImage> aside;
  for (int i = 0; i < count && images.size() > 1; ++i) {
    std::swap(images[random() % images.size()], images.back());
    aside.push_back(std::move(images.back()));
    images.pop_back();
  }
  return aside;
}

}  // namespace

Status TrainOptions::Check() const {
  if (epochs < 1 || batch < 1)
    return Status::Error("train.epochs and train.batch must be at least 1");
  if (side < 32 || side % 32 != 0) return Status::Error("train.side must be a multiple of 32");
  if (distill_epochs < 0 || validation_images < 0 || patience < 0 || threads < 1) {
    return Status::Error(
        "train.distill_epochs, validation_images and patience must not be negative, threads at "
        "least 1");
  }
  if (label_weight < 0 || imitation < 0 || feature_imitation < 0)
    return Status::Error("train: weights of losses must not be negative");
  if (freeze_layers < 0) return Status::Error("train.freeze_layers must not be negative");
  MSF_RETURN_IF_ERROR(optimizer.Check());
  return augmentation.Check();
}

Trainer::Trainer(const ModelConfig& model, const TrainOptions& options,
                 std::vector<LabeledImage> images, ProgressCallback on_progress)
    : options_(options),
      images_(std::move(images)),
      on_progress_(std::move(on_progress)),
      network_(BuildModelGraph(model), static_cast<uint64_t>(options.seed)) {
  torch::set_num_threads(options.threads);
  // The images set aside do not depend on the seed, so that trainings with several seeds can be
  // compared.
  validation_ = SetAside(images_, options.validation_images, 0);
}

Status Trainer::Initialize(const NamedTensors& weights) {
  const StatusOr<NamedTensors> adapted = AdaptWeights(weights, network_.graph());
  if (!adapted.ok()) return adapted.status();
  new_tensors_ = network_.LoadMatching(*adapted);

  const std::string branch = network_.graph().nodes[network_.graph().class_heads[0]].name;
  const auto first = weights.find(branch.substr(0, branch.size() - 2) + ".0.conv.weight");
  const ModelConfig config =
      TeacherConfig(network_.graph().classes, static_cast<int>(first->second.size(0)));
  teacher_ = std::make_unique<Network>(BuildModelGraph(config), 0);
  const StatusOr<NamedTensors> same = AdaptWeights(weights, teacher_->graph());
  if (!same.ok()) return same.status();
  MSF_RETURN_IF_ERROR(teacher_->Load(*same));
  // The class branch was narrowed, so it learns anew, too.
  for (const auto& [name, tensor] : network_.parameters()) {
    if (name.find(".cv3.") == std::string::npos) continue;
    const auto wide = same->find(name);
    if (wide != same->end() && wide->second.sizes() != tensor.sizes()) new_tensors_.push_back(name);
  }
  return Status::Ok();
}

Status Trainer::StartFrom(const NamedTensors& weights) {
  new_tensors_.clear();
  return network_.Load(weights);
}

std::vector<std::string> Trainer::InitializeBlocks() {
  constexpr int kBatches = 8;
  const std::vector<GraphLayer>& layers = network_.graph().layers;
  if (std::none_of(layers.begin(), layers.end(),
                   [](const GraphLayer& layer) { return layer.type == "MSFConv"; }))
    return new_tensors_;
  const EpochSampler sampler = Sampler(-1000, options_.augmentation.mosaic);
  std::vector<torch::Tensor> pictures;
  for (int i = 0; i < std::min(kBatches, sampler.num_batches()); ++i)
    pictures.push_back(sampler.Make(i).images);
  const std::map<int, double> errors =
      InitializeMsfLayers(network_, *teacher_, torch::cat(pictures));
  std::vector<std::string> to_learn = new_tensors_;
  int done = 0;
  for (const auto& [layer, error] : errors) {
    on_progress_({"initialize", 0, 1, done++, static_cast<int>(errors.size()), error});
    if (error > kNothingToLearn) continue;
    const std::string prefix = "model." + std::to_string(layer) + ".";
    std::erase_if(to_learn, [&](const std::string& name) { return name.starts_with(prefix); });
  }
  return to_learn;
}

void Trainer::Distill() {
  if (!teacher_ || new_tensors_.empty() || options_.distill_epochs == 0) return;
  const std::vector<std::string> to_learn = InitializeBlocks();
  const LayerDistillation distillation(network_, *teacher_, to_learn);
  if (distillation.layers().empty()) return;
  const std::set<std::string> trained = ParametersOf(to_learn);
  OptimizerOptions rates;
  rates.learning_rate = options_.distill_rate;
  rates.weight_decay = 0.0;
  Optimizer optimizer(network_.parameters(), rates, trained);
  for (const auto& [name, tensor] : network_.parameters())
    tensor.requires_grad_(trained.contains(name));
  network_.set_training(true);
  for (int epoch = 0; epoch < options_.distill_epochs; ++epoch) {
    // Negative epochs, so that training sees other pictures.
    const EpochSampler sampler = Sampler(-1 - epoch, options_.augmentation.mosaic);
    for (int step = 0; step < sampler.num_batches(); ++step) {
      const torch::Tensor loss = distillation.Loss(sampler.Make(step).images, options_.bfloat16);
      loss.backward();
      const double at = epoch + static_cast<double>(step) / sampler.num_batches();
      optimizer.Step(LearningRateAt(rates, at + 0.05, options_.distill_epochs));
      on_progress_({"distill", epoch, options_.distill_epochs, step, sampler.num_batches(),
                    loss.item<double>()});
    }
  }
  for (const auto& [name, tensor] : network_.parameters()) tensor.requires_grad_(true);
}

std::set<std::string> Trainer::ParametersOf(const std::vector<std::string>& tensors) const {
  std::set<std::string> trained;
  for (const std::string& name : tensors) {
    if (network_.parameters().contains(name)) trained.insert(name);
    // Norms beside new convolutions were taken over but must adapt with them.
    const size_t conv = name.rfind(".conv.weight");
    if (conv == std::string::npos) continue;
    trained.insert(name.substr(0, conv) + ".bn.weight");
    trained.insert(name.substr(0, conv) + ".bn.bias");
  }
  return trained;
}

std::set<std::string> Trainer::TrainedParameters() const {
  std::set<std::string> trained;
  for (const auto& [name, tensor] : network_.parameters()) {
    const int layer = std::stoi(name.substr(std::string("model.").size()));
    if (layer >= options_.freeze_layers) trained.insert(name);
  }
  return trained;
}

EpochSampler Trainer::Sampler(int epoch, double mosaic) const {
  SamplingOptions sampling{options_.side, options_.batch, options_.balance, options_.augmentation};
  sampling.augmentation.mosaic = mosaic;
  return {images_, sampling, static_cast<uint64_t>(options_.seed), epoch};
}

HeadOutputs Trainer::ForwardForTraining(const Batch& batch, Distances& distances) {
  const MixedPrecision mixed(options_.bfloat16);
  const int frozen =
      options_.freeze_layers > 0 ? network_.graph().layers[options_.freeze_layers - 1].end : 1;
  std::vector<torch::Tensor> values(network_.graph().nodes.size());
  values[0] = batch.images.contiguous(torch::MemoryFormat::ChannelsLast);
  {
    const torch::NoGradGuard no_grad;
    network_.set_training(false);
    network_.RunNodes(1, frozen, values);
  }
  network_.set_training(!options_.freeze_norms);
  network_.RunNodes(frozen, static_cast<int>(values.size()), values);
  const bool imitates = options_.imitation > 0.0 || options_.feature_imitation > 0.0;
  if (teacher_ && imitates) distances = Imitate(values, batch);
  return network_.HeadsOf(values);
}

Trainer::Distances Trainer::Imitate(const std::vector<torch::Tensor>& values,
                                    const Batch& batch) const {
  const torch::Tensor turned = batch.angles.abs() > kUpright;
  const torch::Tensor counted =
      options_.imitate_turned ? torch::arange(turned.size(0)) : torch::nonzero(~turned).flatten();
  if (counted.numel() == 0) return {};
  // The teacher has never seen rotated pictures: it is shown them upright.
  const torch::Tensor angles = (batch.angles * turned).index_select(0, counted);
  const torch::Tensor images = batch.images.index_select(0, counted);
  std::vector<torch::Tensor> wanted(teacher_->graph().nodes.size());
  {
    const torch::NoGradGuard no_grad;
    wanted[0] = (options_.imitate_turned ? TurnMaps(images, angles, kGrey) : images)
                    .contiguous(torch::MemoryFormat::ChannelsLast);
    teacher_->RunNodes(1, static_cast<int>(wanted.size()), wanted);
    if (options_.imitate_mirrored) AverageClassesWithMirror(*teacher_, wanted);
  }
  std::vector<torch::Tensor> given(values.size());
  const ModelGraph& graph = network_.graph();
  for (const int node : graph.class_heads) given[node] = values[node].index_select(0, counted);
  Distances distances;
  distances.classes = ClassDistance(network_.HeadsOf(given), teacher_->HeadsOf(wanted), angles);
  if (options_.feature_imitation <= 0.0) return distances;
  for (size_t i = 0; i < graph.layers.size(); ++i) {
    const int node = graph.LayerOutput(static_cast<int>(i));
    if (graph.layers[i].type != "Detect") given[node] = values[node].index_select(0, counted);
  }
  const torch::Tensor upright = torch::nonzero(~turned.index_select(0, counted)).flatten();
  distances.features = FeatureDistance(graph, given, teacher_->graph(), wanted, upright);
  return distances;
}

double Trainer::TrainStep(const Batch& batch, EpochRecord& record) {
  Distances distances;
  const HeadOutputs heads = ForwardForTraining(batch, distances);
  const LossTerms terms = DetectionLoss(DecodeHeads(heads, options_.side), batch.labels);
  const auto images = static_cast<double>(options_.batch);
  const torch::Tensor total =
      images * (options_.label_weight * terms.total + options_.imitation * distances.classes +
                options_.feature_imitation * distances.features);
  total.backward();
  record.box_loss += terms.box;
  record.class_loss += terms.classes;
  record.distribution_loss += terms.distribution;
  record.imitation_loss += distances.classes.item<double>();
  record.feature_loss += distances.features.item<double>();
  return total.item<double>() / images;
}

void Trainer::TrainEpoch(int epoch) {
  const bool last_epochs = epoch >= options_.epochs - options_.mosaic_off_epochs;
  const EpochSampler sampler = Sampler(epoch, last_epochs ? 0.0 : options_.augmentation.mosaic);
  const int steps = sampler.num_batches();
  EpochRecord record;
  record.epoch = epoch + 1;
  for (int step = 0; step < steps; ++step) {
    const double at = epoch + static_cast<double>(step) / steps;
    const double loss = TrainStep(sampler.Make(step), record);
    record.learning_rate = LearningRateAt(options_.optimizer, at + 1.0 / steps, options_.epochs);
    optimizer_->Step(record.learning_rate);
    average_->Update(network_);
    on_progress_({"train", epoch, options_.epochs, step, steps, loss});
  }
  for (double* sum : {&record.box_loss, &record.class_loss, &record.distribution_loss,
                      &record.imitation_loss, &record.feature_loss})
    *sum /= steps;
  ValidateEpoch(record);
  records_.push_back(record);
}

void Trainer::ValidateEpoch(EpochRecord& record) {
  if (validation_.empty()) return;
  Network averaged(network_.graph(), 0);
  const Status loaded = averaged.Load(average_->state());
  MSF_CHECK(loaded.ok(), loaded.message());
  const DetectionMetrics metrics =
      Validate(averaged, validation_, options_.side, 5, options_.bfloat16);
  record.map50 = metrics.map50;
  record.map50_95 = metrics.map50_95;
}

bool Trainer::Stalled() const {
  if (options_.patience == 0 || records_.empty()) return false;
  const auto best = std::max_element(
      records_.begin(), records_.end(),
      [](const EpochRecord& a, const EpochRecord& b) { return a.map50_95 < b.map50_95; });
  return records_.end() - best > options_.patience;
}

Status Trainer::Run(const std::filesystem::path& directory) {
  if (options_.freeze_layers > static_cast<int>(network_.graph().layers.size())) {
    return Status::Error("train.freeze_layers exceeds the model's layers");
  }
  if (images_.empty()) return Status::Error("there are no images to train on");
  const std::filesystem::path checkpoint = directory / "checkpoint.pt";
  std::filesystem::create_directories(directory);
  optimizer_ =
      std::make_unique<Optimizer>(network_.parameters(), options_.optimizer, TrainedParameters());
  optimizer_->ScaleRate(ParametersOf(new_tensors_), options_.new_rate);
  if (std::filesystem::exists(checkpoint)) {
    average_ =
        std::make_unique<WeightAverage>(network_, options_.average_decay, options_.average_ramp);
    MSF_RETURN_IF_ERROR(LoadCheckpoint(checkpoint));
  } else {
    Distill();
    average_ =
        std::make_unique<WeightAverage>(network_, options_.average_decay, options_.average_ramp);
    MSF_RETURN_IF_ERROR(SaveCheckpoint(checkpoint));
  }
  while (static_cast<int>(records_.size()) < options_.epochs && !Stalled()) {
    TrainEpoch(static_cast<int>(records_.size()));
    MSF_RETURN_IF_ERROR(SaveCheckpoint(checkpoint));
    MSF_RETURN_IF_ERROR(SaveTensors(directory / "weights.pt", average_->state()));
    MSF_RETURN_IF_ERROR(WriteCurves(directory, records_));
  }
  return Status::Ok();
}

}  // namespace msf
