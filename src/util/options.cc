#include "util/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <system_error>

namespace msf {
namespace options_internal {

Status Reader::Finish() const {
  if (!status_.ok()) return status_;
  const std::string where = path_.empty() ? "at the top level" : "in section '" + path_ + "'";
  std::set<std::string> given;
  for (const auto& entry : node_) {
    const int line = entry.first.Mark().line + 1;
    if (!entry.first.IsScalar()) {
      return Status::Error(fmt::format("the key {} in line {} is no word; known are: {}", where,
                                       line, fmt::join(known_, ", ")));
    }
    const std::string& key = entry.first.Scalar();
    if (std::find(known_.begin(), known_.end(), key) == known_.end()) {
      return Status::Error(fmt::format("unknown option '{}' {}; known are: {}", key, where,
                                       fmt::join(known_, ", ")));
    }
    if (!given.insert(key).second) {
      return Status::Error(fmt::format("option '{}' {} is given again in line {}; keep one of them",
                                       key, where, line));
    }
  }
  return Status::Ok();
}

YAML::Node NumberNode(double number) {
  return std::isfinite(number) ? YAML::Node(fmt::format("{}", number)) : YAML::Node(number);
}

std::string Describer::Line(const std::string& path, const YAML::Node& value, const char* help) {
  YAML::Emitter emitter;
  emitter << YAML::Flow << value;
  return fmt::format("{:<44} {:<12} {}\n", path, emitter.c_str(), help);
}

}  // namespace options_internal

StatusOr<YAML::Node> LoadYaml(const std::filesystem::path& file) {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored))
    return Status::Error(file.string() + ": is a folder; name a YAML file");
  try {
    const std::vector<YAML::Node> documents = YAML::LoadAllFromFile(file.string());
    if (documents.size() > 1) {
      return Status::Error(
          fmt::format("{}: holds {} documents, separated by '---'; put all keys into one",
                      file.string(), documents.size()));
    }
    return documents.empty() ? YAML::Node() : documents.front();
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
