#include <nlohmann/json.hpp>

#include "detection/compiled_network.h"

namespace msf {

std::string FormatActivationRanges(const ActivationRanges& ranges) {
  nlohmann::json json = nlohmann::json::object();
  for (const auto& [name, range] : ranges) json[name] = {range.low, range.high};
  return json.dump();
}

StatusOr<ActivationRanges> ParseActivationRanges(const std::string& text) {
  const Status damaged =
      Status::Error("the activation ranges in the model are damaged; quantise it again");
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object()) return damaged;
  ActivationRanges ranges;
  for (const auto& [name, range] : json.items()) {
    if (!range.is_array() || range.size() != 2 || !range[0].is_number() || !range[1].is_number())
      return damaged;
    const float low = range[0].get<float>(), high = range[1].get<float>();
    if (!(low <= high && high - low < 1e30f)) return damaged;
    ranges[name] = {low, high};
  }
  return ranges;
}

}  // namespace msf
