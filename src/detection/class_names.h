// The names of a detector's classes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "util/status.h"

namespace msf {

// From a model's metadata: a JSON list ["person", ...] or the form {0: 'person', 1: 'bicycle', ...}
// that common exporters write.
StatusOr<std::vector<std::string>> ParseClassNames(const std::string& text);

// One name per line; empty lines at the end do not count.
StatusOr<std::vector<std::string>> ReadClassNames(const std::filesystem::path& file);

// Data sets call the same things differently: "aeroplane" and "airplane", "sofa" and "couch", ...
// The common name of a class (the one of COCO), in lower case, so that classes of two data sets can
// be matched.
std::string CanonicalClassName(const std::string& name);

// For each of `from` the index in `to` of the class with the same canonical name, or -1.
std::vector<int> MatchClasses(const std::vector<std::string>& from,
                              const std::vector<std::string>& to);

}  // namespace msf
