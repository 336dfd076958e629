#include "detection/class_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

namespace msf {
namespace {

constexpr size_t kMaxClasses = 10000;

// Reads {0: 'person', 1: "traffic light"}: keys count up from 0, names stand in either kind of
// quotes.
class DictionaryReader {
 public:
  explicit DictionaryReader(const std::string& text) : text_(text) {}

  StatusOr<std::vector<std::string>> Read() {
    std::vector<std::string> names;
    if (!Take('{')) return Damaged();
    while (!Take('}')) {
      if (!names.empty() && !Take(',')) return Damaged();
      if (Number() != names.size() || !Take(':') || !Name(names) || names.size() > kMaxClasses)
        return Damaged();
    }
    return names;
  }

 private:
  static Status Damaged() {
    return Status::Error("the class names in the model cannot be read; give them with --classes");
  }
  void SkipSpace() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
  }
  bool Take(char expected) {
    SkipSpace();
    if (at_ >= text_.size() || text_[at_] != expected) return false;
    ++at_;
    return true;
  }
  size_t Number() {
    SkipSpace();
    size_t number = 0, digits = 0;
    for (; at_ < text_.size() && std::isdigit(static_cast<unsigned char>(text_[at_])) && digits < 6;
         ++at_, ++digits) {
      number = number * 10 + static_cast<size_t>(text_[at_] - '0');
    }
    return digits > 0 ? number : kMaxClasses + 1;
  }
  bool Name(std::vector<std::string>& names) {
    SkipSpace();
    if (at_ >= text_.size() || (text_[at_] != '\'' && text_[at_] != '"')) return false;
    const char quote = text_[at_++];
    std::string name;
    for (; at_ < text_.size() && text_[at_] != quote; ++at_) {
      if (text_[at_] == '\\' && at_ + 1 < text_.size()) ++at_;
      name += text_[at_];
    }
    names.push_back(name);
    return at_++ < text_.size();
  }

  const std::string& text_;
  size_t at_ = 0;
};

}  // namespace

StatusOr<std::vector<std::string>> ParseClassNames(const std::string& text) {
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_array()) return DictionaryReader(text).Read();
  std::vector<std::string> names;
  for (const auto& name : json) {
    if (!name.is_string())
      return Status::Error("the class names in the model are no text; give them with --classes");
    names.push_back(name.get<std::string>());
  }
  return names;
}

StatusOr<std::vector<std::string>> ReadClassNames(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream)
    return Status::Error(file.string() + ": the class names cannot be read; check the path");
  std::vector<std::string> names;
  for (std::string line; std::getline(stream, line) && names.size() <= kMaxClasses;) {
    while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back()))) line.pop_back();
    names.push_back(line);
  }
  while (!names.empty() && names.back().empty()) names.pop_back();
  if (names.empty())
    return Status::Error(file.string() + ": holds no class names, one per line is expected");
  if (std::count(names.begin(), names.end(), "") > 0) {
    return Status::Error(file.string() + ": has an empty line between class names");
  }
  return names;
}

std::string CanonicalClassName(const std::string& name) {
  static const std::map<std::string, std::string> kNames = {
      {"aeroplane", "airplane"}, {"motorbike", "motorcycle"},     {"sofa", "couch"},
      {"tvmonitor", "tv"},       {"diningtable", "dining table"}, {"pottedplant", "potted plant"},
      {"people", "person"}};
  std::string lower = name;
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  const auto found = kNames.find(lower);
  return found == kNames.end() ? lower : found->second;
}

std::vector<int> MatchClasses(const std::vector<std::string>& from,
                              const std::vector<std::string>& to) {
  std::vector<int> matches;
  for (const std::string& name : from) {
    const auto same = [&](const std::string& other) {
      return CanonicalClassName(other) == CanonicalClassName(name);
    };
    const auto found = std::find_if(to.begin(), to.end(), same);
    matches.push_back(found == to.end() ? -1 : static_cast<int>(found - to.begin()));
  }
  return matches;
}

}  // namespace msf
