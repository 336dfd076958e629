#include "util/atomic_file.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iostream>
#include <system_error>
#include <utility>

namespace msf {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxLinks = 40;  // as the kernel

// Calls `write`; why that failed, or nothing when all has been taken.
std::string Fill(std::ostream& stream, const std::function<void(std::ostream&)>& write) {
  errno = 0;
  if (stream) write(stream);
  stream.flush();
  if (stream) return {};
  return errno != 0 ? std::strerror(errno) : "the write failed";
}

std::string FillFile(const fs::path& file, const std::function<void(std::ostream&)>& write) {
  errno = 0;
  std::ofstream stream(file, std::ios::binary);
  if (!stream) return std::strerror(errno);
  const std::string problem = Fill(stream, write);
  stream.close();
  return problem.empty() && !stream ? "the write failed" : problem;
}

// The open stream that goes to the same place as `path` (/dev/stdout, for one), else null. Opened a
// second time, a file would be written over from its start.
std::ostream* StandardStreamAt(const fs::path& path) {
  struct stat wanted {};
  struct stat open {};
  if (stat(path.c_str(), &wanted) != 0) return nullptr;
  for (const auto& [descriptor, stream] :
       {std::pair(STDOUT_FILENO, &std::cout), std::pair(STDERR_FILENO, &std::cerr)}) {
    if (fstat(descriptor, &open) == 0 && open.st_dev == wanted.st_dev &&
        open.st_ino == wanted.st_ino)
      return stream;
  }
  return nullptr;
}

// A file that goes with the object, unless it has got another name.
struct TemporaryFile {
  ~TemporaryFile() {
    std::error_code ignored;
    fs::remove(name, ignored);
  }
  const fs::path name;
};

std::string Replace(const fs::path& file, const std::function<void(std::ostream&)>& write) {
  const TemporaryFile temporary{fmt::format("{}.{}.part", file.string(), getpid())};
  if (std::string problem = FillFile(temporary.name, write); !problem.empty()) return problem;
  std::error_code error;
  fs::rename(temporary.name, file, error);
  return error ? error.message() : std::string();
}

std::string Write(const fs::path& path, const std::function<void(std::ostream&)>& write) {
  if (std::ostream* const stream = StandardStreamAt(path)) return Fill(*stream, write);
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::none) return error.message();
  const bool is_replaceable = !fs::exists(status) || fs::is_regular_file(status);
  return is_replaceable ? Replace(ResolvePath(path), write) : FillFile(path, write);
}

}  // namespace

Status WriteFileAtomically(const fs::path& path, const std::function<void(std::ostream&)>& write) {
  const std::string problem = Write(path, write);
  if (problem.empty()) return Status::Ok();
  return Status::Error(fmt::format("{}: cannot be written: {}", path.string(), problem));
}

Status WriteFileAtomically(const fs::path& path, std::string_view content) {
  return WriteFileAtomically(path, [content](std::ostream& stream) { stream << content; });
}

fs::path ResolvePath(const fs::path& path) {
  std::error_code error;
  fs::path place = fs::absolute(path, error);
  for (int i = 0; i < kMaxLinks && fs::is_symlink(fs::symlink_status(place, error)); ++i)
    place = place.parent_path() / fs::read_symlink(place, error);
  const fs::path whole = fs::weakly_canonical(place, error);
  if (!error) place = whole;
  return place.has_filename() ? place : place.parent_path();
}

}  // namespace msf
