// Where the files that come with the program are.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "util/status.h"

namespace msf {

// The folders that may hold the program's data, in the order in which they are searched: the
// environment variable MSF_SLAM_DATA, share/msf_slam beside the running program's bin/,
// share/msf_slam of the installation, and the source tree that the library was built from.
std::vector<std::filesystem::path> DataFolders();

// The first of these folders' `name` (such as "models/vocabulary.msfvoc") that exists; an error
// lists where it was looked for.
StatusOr<std::filesystem::path> FindDataFile(const std::string& name);

}  // namespace msf
