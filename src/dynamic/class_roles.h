// Which of a detector's classes move.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dynamic/dynamic_options.h"

namespace msf {

enum class ObjectKind {
  kKnown,      // of a class that moves by itself
  kPotential,  // of a class that people move
  kUnknown,    // found by its motion alone
};
const char* ToString(ObjectKind kind);

class ClassRoles {
 public:
  // No class at all (no detector) is fine; a detector none of whose classes is listed is an error,
  // and so is a score that cannot be read.
  static StatusOr<ClassRoles> Create(const DynamicOptions& options,
                                     const std::vector<std::string>& class_names);
  ClassRoles() = default;

  // Nothing for classes that stay where they are.
  std::optional<ObjectKind> KindOf(int class_id) const;
  // The score with which a detection of a class that KindOf() knows starts an object.
  double StartScoreOf(int class_id) const;
  // The name of a class; "mover" for -1.
  std::string NameOf(int class_id) const;

 private:
  std::vector<std::string> names_;
  std::vector<std::optional<ObjectKind>> kinds_;
  std::vector<double> start_scores_;
};

}  // namespace msf
