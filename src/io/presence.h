// Whether a file is there, for those who read it next.
#pragma once

#include <filesystem>
#include <system_error>

namespace msf {

// What cannot be looked at counts as there, as does a link that leads nowhere or in a circle: who
// reads it then says what is wrong with it.
inline bool IsThere(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::symlink_status(path, ignored).type() !=
         std::filesystem::file_type::not_found;
}

// False also for what cannot be looked at.
inline bool IsFolder(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_directory(path, ignored);
}

}  // namespace msf
