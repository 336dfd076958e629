// SGD and AdamW over named tensors, the moving average of weights, and the schedule of learning
// rates. State is plain named tensors, so that a checkpoint holds all of it.
#pragma once

#include <map>
#include <set>
#include <string>

#include "training/network.h"

namespace msf {

struct OptimizerOptions {
  std::string method = "adamw";
  double learning_rate = 5e-5;
  double final_fraction = 0.02;
  std::string decay = "cosine";
  double momentum = 0.9;
  double weight_decay = 0.01;
  double warmup_epochs = 0.3;
  double clip_norm = 10.0;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("method", method, "adamw or sgd (Nesterov)");
    visit("learning_rate", learning_rate, "largest learning rate");
    visit("final_fraction", final_fraction, "learning rate at the end, as a part of the largest");
    visit("decay", decay, "cosine or linear");
    visit("momentum", momentum, "momentum of SGD, decay of AdamW's first moment");
    visit("weight_decay", weight_decay,
          "weight decay of convolution weights (not of norms and biases)");
    visit("warmup_epochs", warmup_epochs, "epochs in which the learning rate rises from 0");
    visit("clip_norm", clip_norm, "largest norm of the gradient");
  }
  Status Check() const;
};

// Learning rate `epoch` (with fraction) epochs into a training of `epochs`.
double LearningRateAt(const OptimizerOptions& options, double epoch, double epochs);

class Optimizer {
 public:
  // Trains the `parameters` listed in `trained`; all of them where that is empty.
  Optimizer(const NamedTensors& parameters, const OptimizerOptions& options,
            const std::set<std::string>& trained = {});

  // The named parameters learn `factor` times as fast as the others.
  void ScaleRate(const std::set<std::string>& names, double factor);

  // One step along the gradients (clipped), which are then cleared.
  void Step(double learning_rate);

  NamedTensors State() const;
  void Load(const NamedTensors& state);

 private:
  double ClipFactor() const;
  void StepAdamW(const std::string& name, torch::Tensor& parameter, const torch::Tensor& gradient,
                 double learning_rate);
  void StepSgd(const std::string& name, torch::Tensor& parameter, const torch::Tensor& gradient,
               double learning_rate);

  OptimizerOptions options_;
  NamedTensors parameters_;
  std::map<std::string, double> rate_scale_;
  NamedTensors first_;   // momentum
  NamedTensors second_;  // AdamW: mean squares
  int64_t steps_ = 0;
};

// Moving average of a network's state: average = d * average + (1 - d) * state, d = decay * (1 -
// exp(-updates / ramp)).
class WeightAverage {
 public:
  WeightAverage(const Network& network, double decay, double ramp);
  void Update(const Network& network);

  const NamedTensors& state() const { return state_; }
  int64_t updates() const { return updates_; }
  void Load(const NamedTensors& state, int64_t updates);

 private:
  double decay_;
  double ramp_;
  int64_t updates_ = 0;
  NamedTensors state_;
};

}  // namespace msf
