#include <torch/types.h>
#include <torch/utils.h>

#include <functional>

#include "training/trainer.h"
#include "util/options.h"

namespace msf {

namespace {

constexpr int kRecordFields = 9;

void Insert(NamedTensors& target, const std::string& prefix, const NamedTensors& source) {
  for (const auto& [name, tensor] : source) target[prefix + name] = tensor;
}

NamedTensors Extract(const NamedTensors& source, const std::string& prefix) {
  NamedTensors result;
  for (const auto& [name, tensor] : source) {
    if (name.starts_with(prefix)) result[name.substr(prefix.size())] = tensor;
  }
  return result;
}

torch::Tensor RecordToTensor(const EpochRecord& r) {
  return torch::tensor({static_cast<double>(r.epoch), r.learning_rate, r.box_loss, r.class_loss,
                        r.distribution_loss, r.imitation_loss, r.feature_loss, r.map50,
                        r.map50_95});
}

EpochRecord RecordFromTensor(const torch::Tensor& row) {
  const auto v = row.accessor<float, 1>();
  return {static_cast<int>(v[0]), v[1], v[2], v[3], v[4], v[5], v[6], v[7], v[8]};
}

}  // namespace

std::string Trainer::OptionsFingerprint() const {
  YAML::Emitter text;
  text << OptionsToYaml(options_);
  return network_.graph().name + "\n" + text.c_str();
}

Status Trainer::SaveCheckpoint(const std::filesystem::path& file) const {
  NamedTensors all;
  Insert(all, "network/", network_.State());
  Insert(all, "average/", average_->state());
  Insert(all, "optimizer/", optimizer_->State());
  all["average_updates"] = torch::tensor(static_cast<float>(average_->updates()));
  all["records"] = torch::zeros({static_cast<int64_t>(records_.size()), kRecordFields});
  for (size_t i = 0; i < records_.size(); ++i)
    all["records"][static_cast<int64_t>(i)] = RecordToTensor(records_[i]);
  const std::string fingerprint = OptionsFingerprint();
  all["options"] =
      torch::tensor(std::vector<int>(fingerprint.begin(), fingerprint.end())).to(torch::kFloat);
  return SaveTensors(file, all);
}

Status Trainer::LoadCheckpoint(const std::filesystem::path& file) {
  const StatusOr<NamedTensors> all = LoadTensors(file);
  if (!all.ok()) return all.status();
  if (!all->contains("options") || !all->contains("records")) {
    return Status::Error(file.string() + ": is no checkpoint of a training");
  }
  const torch::Tensor letters = all->at("options");
  std::string fingerprint;
  for (int64_t i = 0; i < letters.size(0); ++i)
    fingerprint += static_cast<char>(letters[i].item<float>());
  if (fingerprint != OptionsFingerprint()) {
    return Status::Error(file.string() +
                         ": was written by a training with another model or other options; give "
                         "another --out or the same options");
  }
  MSF_RETURN_IF_ERROR(network_.Load(Extract(*all, "network/")));
  optimizer_->Load(Extract(*all, "optimizer/"));
  average_->Load(Extract(*all, "average/"),
                 static_cast<int64_t>(all->at("average_updates").item<float>()));
  records_.clear();
  const torch::Tensor& rows = all->at("records");
  for (int64_t i = 0; i < rows.size(0); ++i) records_.push_back(RecordFromTensor(rows[i]));
  return Status::Ok();
}

}  // namespace msf
