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
// and the system's reason (disk full, no permission, ...).
Status WriteFileAtomically(const std::filesystem::path& path,
                           const std::function<void(std::ostream&)>& write);

// The same for text that is at hand.
Status WriteFileAtomically(const std::filesystem::path& path, std::string_view content);

}  // namespace msf
