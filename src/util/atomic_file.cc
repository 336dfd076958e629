#include "util/atomic_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

namespace msf {

Status WriteFileAtomically(const std::filesystem::path& path,
                           const std::function<void(std::ostream&)>& write) {
  const std::filesystem::path temporary = fmt::format("{}.{}.part", path.string(), getpid());
  errno = 0;
  std::ofstream stream(temporary, std::ios::binary);
  if (stream) write(stream);
  stream.close();
  if (!stream) {
    const std::string reason = errno != 0 ? std::strerror(errno) : "the write failed";
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    return Status::Error(fmt::format("{}: cannot be written: {}", path.string(), reason));
  }
  std::error_code error;
  std::filesystem::rename(temporary, path, error);
  if (!error) return Status::Ok();
  std::error_code ignored;
  std::filesystem::remove(temporary, ignored);
  return Status::Error(fmt::format("{}: cannot be written: {}", path.string(), error.message()));
}

Status WriteFileAtomically(const std::filesystem::path& path, std::string_view content) {
  return WriteFileAtomically(path, [content](std::ostream& stream) { stream << content; });
}

}  // namespace msf
