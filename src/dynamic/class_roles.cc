#include "dynamic/class_roles.h"

#include <algorithm>

#include "detection/class_names.h"

namespace msf {
namespace {

bool Lists(const std::vector<std::string>& list, const std::string& name) {
  return std::any_of(list.begin(), list.end(), [&](const std::string& listed) {
    return CanonicalClassName(listed) == CanonicalClassName(name);
  });
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
  ClassRoles roles;
  roles.names_ = class_names;
  for (const std::string& name : class_names) {
    std::optional<ObjectKind> kind;
    if (Lists(options.potential_classes, name)) kind = ObjectKind::kPotential;
    if (Lists(options.known_classes, name)) kind = ObjectKind::kKnown;
    roles.kinds_.push_back(kind);
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

std::string ClassRoles::NameOf(int class_id) const {
  if (class_id < 0 || class_id >= static_cast<int>(names_.size())) return "mover";
  return names_[class_id];
}

}  // namespace msf
