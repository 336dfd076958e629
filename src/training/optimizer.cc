#include "training/optimizer.h"

#include <torch/types.h>
#include <torch/utils.h>

#include <algorithm>
#include <cmath>

namespace msf {

namespace {

constexpr double kSecondMomentDecay = 0.999;
constexpr double kEpsilon = 1e-8;

}  // namespace

Status OptimizerOptions::Check() const {
  if (method != "adamw" && method != "sgd")
    return Status::Error("optimizer.method must be adamw or sgd, not '" + method + "'");
  if (decay != "cosine" && decay != "linear")
    return Status::Error("optimizer.decay must be cosine or linear, not '" + decay + "'");
  if (!(learning_rate > 0.0)) return Status::Error("optimizer.learning_rate must be positive");
  if (!(momentum >= 0.0 && momentum < 1.0))
    return Status::Error("optimizer.momentum must lie in [0, 1)");
  if (!(clip_norm > 0.0)) return Status::Error("optimizer.clip_norm must be positive");
  return Status::Ok();
}

double LearningRateAt(const OptimizerOptions& options, double epoch, double epochs) {
  const double progress = std::clamp(epoch / epochs, 0.0, 1.0);
  const double shape =
      options.decay == "cosine" ? 0.5 * (1.0 + std::cos(M_PI * progress)) : 1.0 - progress;
  const double warmup =
      options.warmup_epochs > 0.0 ? std::min(1.0, epoch / options.warmup_epochs) : 1.0;
  return options.learning_rate * warmup *
         (options.final_fraction + (1.0 - options.final_fraction) * shape);
}

Optimizer::Optimizer(const NamedTensors& parameters, const OptimizerOptions& options,
                     const std::set<std::string>& trained)
    : options_(options) {
  for (const auto& [name, tensor] : parameters) {
    if (!trained.empty() && !trained.contains(name)) continue;
    parameters_[name] = tensor;
    first_[name] = torch::zeros_like(tensor);
    if (options.method == "adamw") second_[name] = torch::zeros_like(tensor);
  }
}

void Optimizer::ScaleRate(const std::set<std::string>& names, double factor) {
  for (const std::string& name : names) rate_scale_[name] = factor;
}

double Optimizer::ClipFactor() const {
  double squares = 0.0;
  for (const auto& [name, parameter] : parameters_) {
    if (parameter.grad().defined()) squares += parameter.grad().square().sum().item<double>();
  }
  return std::min(1.0, options_.clip_norm / (std::sqrt(squares) + 1e-6));
}

void Optimizer::Step(double learning_rate) {
  const torch::NoGradGuard no_grad;
  const double clip = ClipFactor();
  ++steps_;
  for (auto& [name, parameter] : parameters_) {
    torch::Tensor& gradient = parameter.mutable_grad();
    if (!gradient.defined()) continue;
    if (clip < 1.0) gradient.mul_(clip);
    const auto scale = rate_scale_.find(name);
    const double rate = scale == rate_scale_.end() ? learning_rate : learning_rate * scale->second;
    if (options_.method == "adamw") {
      StepAdamW(name, parameter, gradient, rate);
    } else {
      StepSgd(name, parameter, gradient, rate);
    }
    gradient.reset();
  }
}

void Optimizer::StepAdamW(const std::string& name, torch::Tensor& parameter,
                          const torch::Tensor& gradient, double learning_rate) {
  if (parameter.dim() > 1) parameter.mul_(1.0 - learning_rate * options_.weight_decay);
  torch::Tensor& mean = first_[name];
  torch::Tensor& square = second_[name];
  mean.mul_(options_.momentum).add_(gradient, 1.0 - options_.momentum);
  square.mul_(kSecondMomentDecay).addcmul_(gradient, gradient, 1.0 - kSecondMomentDecay);
  const auto t = static_cast<double>(steps_);
  const double mean_scale = 1.0 - std::pow(options_.momentum, t);
  const double square_scale = std::sqrt(1.0 - std::pow(kSecondMomentDecay, t));
  parameter.addcdiv_(mean, square.sqrt().div_(square_scale).add_(kEpsilon),
                     -learning_rate / mean_scale);
}

void Optimizer::StepSgd(const std::string& name, torch::Tensor& parameter,
                        const torch::Tensor& gradient, double learning_rate) {
  const torch::Tensor full =
      parameter.dim() > 1 ? gradient + parameter * options_.weight_decay : gradient;
  torch::Tensor& velocity = first_[name];
  velocity.mul_(options_.momentum).add_(full);
  parameter.add_(full + velocity * options_.momentum, -learning_rate);
}

NamedTensors Optimizer::State() const {
  NamedTensors state;
  for (const auto& [name, tensor] : first_) state["first/" + name] = tensor;
  for (const auto& [name, tensor] : second_) state["second/" + name] = tensor;
  state["steps"] = torch::tensor(static_cast<float>(steps_));
  return state;
}

void Optimizer::Load(const NamedTensors& state) {
  for (auto& [name, tensor] : first_) tensor.copy_(state.at("first/" + name));
  for (auto& [name, tensor] : second_) tensor.copy_(state.at("second/" + name));
  steps_ = static_cast<int64_t>(state.at("steps").item<float>());
}

WeightAverage::WeightAverage(const Network& network, double decay, double ramp)
    : decay_(decay), ramp_(ramp), state_(network.State()) {}

void WeightAverage::Update(const Network& network) {
  const torch::NoGradGuard no_grad;
  const double keep = decay_ * (1.0 - std::exp(-static_cast<double>(++updates_) / ramp_));
  for (const NamedTensors* tensors : {&network.parameters(), &network.buffers()}) {
    for (const auto& [name, tensor] : *tensors) state_[name].lerp_(tensor.detach(), 1.0 - keep);
  }
}

void WeightAverage::Load(const NamedTensors& state, int64_t updates) {
  for (auto& [name, tensor] : state_) tensor.copy_(state.at(name));
  updates_ = updates;
}

}  // namespace msf
