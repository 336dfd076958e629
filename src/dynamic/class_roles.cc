#include "dynamic/class_roles.h"

#include <algorithm>
#include <cstdlib>
#include <map>

#include "detection/class_names.h"

namespace msf {
namespace {

bool Lists(const std::vector<std::string>& list, const std::string& name) {
  return std::any_of(list.begin(), list.end(), [&](const std::string& listed) {
    return CanonicalClassName(listed) == CanonicalClassName(name);
  });
}

// "cat=0.6" becomes {"cat", 0.6}, with the name in its canonical form.
StatusOr<std::map<std::string, double>> ReadScores(const std::vector<std::string>& class_scores) {
  std::map<std::string, double> scores;
  for (const std::string& text : class_scores) {
    const size_t equals = text.find('=');
    char* end = nullptr;
    const std::string number = equals == std::string::npos ? "" : text.substr(equals + 1);
    const double score = std::strtod(number.c_str(), &end);
    if (number.empty() || *end != '\0' || !(score >= 0 && score <= 1)) {
      return Status::Error("dynamic.class_scores: '" + text +
                           "' is not a class and its score, such as cat=0.6");
    }
    scores[CanonicalClassName(text.substr(0, equals))] = score;
  }
  return scores;
}

}  // namespace

const char* ToString(ObjectKind kind) {
  switch (kind) {
    case ObjectKind::kKnown:
      return "known";
    case ObjectKind::kPotential:
      return "potential";
    case ObjectKind::kUnknown:
      return "unknown";
  }
  return "unknown";
}

StatusOr<ClassRoles> ClassRoles::Create(const DynamicOptions& options,
                                        const std::vector<std::string>& class_names) {
  const StatusOr<std::map<std::string, double>> scores = ReadScores(options.class_scores);
  if (!scores.ok()) return scores.status();
  for (const auto& [name, score] : *scores) {
    if (!class_names.empty() && !Lists(class_names, name)) {
      return Status::Error("dynamic.class_scores: the detector has no class '" + name + "'");
    }
  }
  ClassRoles roles;
  roles.names_ = class_names;
  for (const std::string& name : class_names) {
    std::optional<ObjectKind> kind;
    if (Lists(options.potential_classes, name)) kind = ObjectKind::kPotential;
    if (Lists(options.known_classes, name)) kind = ObjectKind::kKnown;
    roles.kinds_.push_back(kind);
    const auto own = scores->find(CanonicalClassName(name));
    const double of_kind =
        kind == ObjectKind::kKnown ? options.tracks.start_score : options.tracks.potential_score;
    roles.start_scores_.push_back(own == scores->end() ? of_kind : own->second);
  }
  const bool any = std::any_of(roles.kinds_.begin(), roles.kinds_.end(),
                               [](const auto& kind) { return kind.has_value(); });
  if (!class_names.empty() && !any) {
    return Status::Error(
        "none of the detector's classes ('" + class_names.front() +
        "', ...) is in dynamic.known_classes or dynamic.potential_classes; add the ones that move");
  }
  return roles;
}

std::optional<ObjectKind> ClassRoles::KindOf(int class_id) const {
  if (class_id < 0 || class_id >= static_cast<int>(kinds_.size())) return std::nullopt;
  return kinds_[class_id];
}

double ClassRoles::StartScoreOf(int class_id) const { return start_scores_.at(class_id); }

std::string ClassRoles::NameOf(int class_id) const {
  if (class_id < 0 || class_id >= static_cast<int>(names_.size())) return "mover";
  return names_[class_id];
}

}  // namespace msf
