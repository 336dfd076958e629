#include "util/options.h"

#include <fmt/format.h>

#include <algorithm>

namespace msf {
namespace options_internal {

Status Reader::Finish() const {
  if (!status_.ok()) return status_;
  for (const auto& entry : node_) {
    const std::string key = entry.first.as<std::string>();
    if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
    const std::string where = path_.empty() ? "at the top level" : "in section '" + path_ + "'";
    return Status::Error(
        fmt::format("unknown option '{}' {}; known are: {}", key, where, fmt::join(known_, ", ")));
  }
  return Status::Ok();
}

std::string Describer::Line(const std::string& path, const YAML::Node& value, const char* help) {
  YAML::Emitter emitter;
  emitter << YAML::Flow << value;
  return fmt::format("{:<44} {:<12} {}\n", path, emitter.c_str(), help);
}

}  // namespace options_internal

StatusOr<YAML::Node> LoadYaml(const std::filesystem::path& file) {
  try {
    return YAML::LoadFile(file.string());
  } catch (const YAML::BadFile&) {
    return Status::Error(file.string() + ": cannot be read; check the path");
  } catch (const YAML::Exception& error) {
    return Status::Error(
        fmt::format("{}:{}: not valid YAML: {}", file.string(), error.mark.line + 1, error.msg));
  }
}

StatusOr<YAML::Node> ParseAssignment(const std::string& assignment) {
  const size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0) {
    return Status::Error("'" + assignment + "' is not of the form section.key=value");
  }
  YAML::Node value;
  try {
    value = YAML::Load(assignment.substr(equals + 1));
  } catch (const YAML::Exception&) {
    return Status::Error("the value of '" + assignment + "' cannot be read");
  }
  std::string path = assignment.substr(0, equals);
  for (size_t dot = path.rfind('.');; dot = path.rfind('.')) {
    YAML::Node section(YAML::NodeType::Map);
    section[dot == std::string::npos ? path : path.substr(dot + 1)] = value;
    value = section;
    if (dot == std::string::npos) return value;
    path.resize(dot);
  }
}

}  // namespace msf
