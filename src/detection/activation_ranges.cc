#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "detection/compiled_network.h"

namespace msf {
namespace {

// Four digits are more than the means of other images would share.
std::vector<double> Rounded(const std::vector<float>& means) {
  std::vector<double> rounded;
  rounded.reserve(means.size());
  for (const float mean : means) rounded.push_back(std::stod(fmt::format("{:.4g}", mean)));
  return rounded;
}

bool IsRange(const nlohmann::json& range) {
  return range.is_array() && (range.size() == 2 || (range.size() == 3 && range[2].is_array())) &&
         range[0].is_number() && range[1].is_number();
}

}  // namespace

std::string FormatActivationRanges(const ActivationRanges& ranges) {
  nlohmann::json json = nlohmann::json::object();
  for (const auto& [name, range] : ranges) {
    json[name] = {range.low, range.high};
    if (!range.means.empty()) json[name].push_back(Rounded(range.means));
  }
  return json.dump();
}

StatusOr<ActivationRanges> ParseActivationRanges(const std::string& text) {
  const Status damaged =
      Status::Error("the activation ranges in the model are damaged; quantise it again");
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object()) return damaged;
  ActivationRanges ranges;
  for (const auto& [name, range] : json.items()) {
    if (!IsRange(range)) return damaged;
    const float low = range[0].get<float>(), high = range[1].get<float>();
    if (!(low <= high && high - low < 1e30f)) return damaged;
    ranges[name] = {low, high, {}};
    if (range.size() == 2) continue;
    for (const nlohmann::json& mean : range[2]) {
      if (!mean.is_number() || !(std::abs(mean.get<double>()) < 1e30)) return damaged;
      ranges[name].means.push_back(mean.get<float>());
    }
  }
  return ranges;
}

}  // namespace msf
