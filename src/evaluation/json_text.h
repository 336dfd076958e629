// JSON as the text of a file.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace msf {

// Names of files may be in any encoding: bytes that are no UTF-8 are replaced by U+FFFD.
inline std::string JsonText(const nlohmann::json& json, int indent = 2) {
  return json.dump(indent, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace msf
