// Files that are either complete or not there: written to a temporary name beside the target, then
// renamed.
#pragma once

#include <filesystem>
#include <functional>
#include <ostream>
#include <string_view>

#include "util/status.h"

namespace msf {

// Calls `write` with a stream; when it and the disk agree that all went well the file appears at
// `path`, replacing an older one. Otherwise nothing changes at `path` and the error names the file
// and the system's reason (disk full, no permission, ...). A link stays: the file that it points to
// is written. What is no file (a pipe, a device, where stdout goes) is written to, not replaced.
Status WriteFileAtomically(const std::filesystem::path& path,
                           const std::function<void(std::ostream&)>& write);

// The same for text that is at hand.
Status WriteFileAtomically(const std::filesystem::path& path, std::string_view content);

// Where something of this name is or will be: absolute, with links followed and without a slash at
// its end. Two names of the same place give the same path.
std::filesystem::path ResolvePath(const std::filesystem::path& path);

}  // namespace msf
