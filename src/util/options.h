// Options: every module has a plain struct of fields with defaults that lists them once in Visit():
//
//   struct OrbOptions {
//     int num_features = 1000;
//     template <typename Visitor> void Visit(Visitor& visit) {
//       visit("num_features", num_features, "points per image");
//     }
//     Status Check() const;   // a sentence when a value makes no sense
//   };
//
// A field that has a Visit() of its own is a section; a std::vector of such fields is a list of
// sections. From that one list come reading YAML with unknown keys as errors,
// `--set section.key=value`, the resolved file next to every run's results, and the reference of
// all options.
#pragma once

#include <yaml-cpp/yaml.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <type_traits>
#include <vector>

#include "util/status.h"

namespace msf {

namespace options_internal {

struct AnyVisitor {
  template <typename T>
  void operator()(const char*, T&, const char*) {}
};

template <typename T>
concept Section = requires(T options, AnyVisitor visitor) {
  options.Visit(visitor);
};

template <typename T>
constexpr bool kIsSectionList = false;
template <Section T>
constexpr bool kIsSectionList<std::vector<T>> = true;

template <typename T>
std::string TypeName() {
  if constexpr (std::is_same_v<T, bool>)
    return "true or false";
  else if constexpr (std::is_integral_v<T>)
    return "a whole number";
  else if constexpr (std::is_floating_point_v<T>)
    return "a finite number";
  else if constexpr (std::is_same_v<T, std::string>)
    return "text";
  else
    return "a list";
}

template <typename T>
bool IsFinite(const T& value) {
  if constexpr (std::is_floating_point_v<T>)
    return std::isfinite(value);
  else
    return true;
}

// In the fewest digits that read back as the same number: 0.7, not 0.69999999999999996.
YAML::Node NumberNode(double number);

template <typename T>
YAML::Node ValueNode(const T& value) {
  if constexpr (std::is_same_v<T, double>)
    return NumberNode(value);
  else
    return YAML::Node(value);
}

// Copies the keys of a YAML map into the fields and remembers which keys it knew.
class Reader {
 public:
  Reader(const YAML::Node& node, std::string path) : node_(node), path_(std::move(path)) {}

  template <typename T>
  void operator()(const char* key, T& field, const char*) {
    known_.emplace_back(key);
    if (!status_.ok() || !node_[key]) return;
    const std::string path = path_.empty() ? key : path_ + "." + key;
    if constexpr (Section<T>) {
      status_ = ReadSection(node_[key], path, field);
    } else if constexpr (kIsSectionList<T>) {
      ReadSectionList(node_[key], path, field);
    } else {
      ReadValue(node_[key], path, field);
    }
  }

  Status Finish() const;

 private:
  template <typename T>
  static Status ReadSection(const YAML::Node& node, const std::string& path, T& field) {
    if (!node.IsMap())
      return Status::Error("option '" + path + "' is a section and needs keys below it");
    Reader section(node, path);
    field.Visit(section);
    return section.Finish();
  }

  template <typename T>
  void ReadValue(const YAML::Node& node, const std::string& path, T& field) {
    try {
      const T value = node.as<T>();
      if (IsFinite(value)) {
        field = value;
        return;
      }
    } catch (const YAML::Exception&) {  // of another type: the same sentence
    }
    status_ = Status::Error("option '" + path + "' needs " + TypeName<T>());
  }

  template <typename T>
  void ReadSectionList(const YAML::Node& node, const std::string& path, std::vector<T>& list) {
    if (!node.IsSequence()) {
      status_ = Status::Error("option '" + path + "' needs a list");
      return;
    }
    list.assign(node.size(), T());
    for (size_t i = 0; i < list.size() && status_.ok(); ++i) {
      status_ = ReadSection(node[i], path + "[" + std::to_string(i) + "]", list[i]);
    }
  }

  YAML::Node node_;
  std::string path_;
  std::vector<std::string> known_;
  Status status_;
};

class Writer {
 public:
  template <typename T>
  void operator()(const char* key, T& field, const char*) {
    if constexpr (Section<T>) {
      Writer section;
      field.Visit(section);
      node_[key] = section.node();
    } else if constexpr (kIsSectionList<T>) {
      node_[key] = YAML::Node(YAML::NodeType::Sequence);
      for (auto& entry : field) {
        Writer section;
        entry.Visit(section);
        node_[key].push_back(section.node());
      }
    } else {
      node_[key] = ValueNode(field);
    }
  }
  const YAML::Node& node() const { return node_; }

 private:
  YAML::Node node_{YAML::NodeType::Map};
};

class Describer {
 public:
  explicit Describer(std::string path) : path_(std::move(path)) {}
  template <typename T>
  void operator()(const char* key, T& field, const char* help) {
    const std::string path = path_.empty() ? key : path_ + "." + key;
    if constexpr (Section<T>) {
      Describer section(path);
      field.Visit(section);
      text_ += section.text();
    } else if constexpr (kIsSectionList<T>) {
      typename T::value_type entry;
      Describer section(path + "[]");
      entry.Visit(section);
      text_ += section.text();
    } else {
      text_ += Line(path, ValueNode(field), help);
    }
  }
  const std::string& text() const { return text_; }

 private:
  static std::string Line(const std::string& path, const YAML::Node& value, const char* help);
  std::string path_;
  std::string text_;
};

}  // namespace options_internal

// Overwrites the fields that `node` names; an unknown or repeated key and a value of the wrong type
// are errors that name it.
template <typename Options>
Status ReadOptions(const YAML::Node& node, Options& options) {
  if (!node.IsMap())
    return node.IsNull() ? Status::Ok() : Status::Error("options need the form 'key: value'");
  options_internal::Reader reader(node, "");
  options.Visit(reader);
  return reader.Finish();
}

// Reads a YAML file of one document; errors name the file.
StatusOr<YAML::Node> LoadYaml(const std::filesystem::path& file);

template <typename Options>
Status LoadOptions(const std::filesystem::path& file, Options& options) {
  StatusOr<YAML::Node> node = LoadYaml(file);
  if (!node.ok()) return node.status();
  const Status status = ReadOptions(*node, options);
  return status.ok() ? status : Status::Error(file.string() + ": " + status.message());
}

// Turns "section.key=value" into the YAML map {section: {key: value}}.
StatusOr<YAML::Node> ParseAssignment(const std::string& assignment);

// Applies one "section.key=value".
template <typename Options>
Status SetOption(const std::string& assignment, Options& options) {
  StatusOr<YAML::Node> node = ParseAssignment(assignment);
  return node.ok() ? ReadOptions(*node, options) : node.status();
}

// All fields with their present values.
template <typename Options>
YAML::Node OptionsToYaml(Options options) {
  options_internal::Writer writer;
  options.Visit(writer);
  return writer.node();
}

// One line per option: path, default, help.
template <typename Options>
std::string DescribeOptions(Options options = {}) {
  options_internal::Describer describer("");
  options.Visit(describer);
  return describer.text();
}

}  // namespace msf
