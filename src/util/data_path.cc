#include "util/data_path.h"

#include <fmt/format.h>

#include <cstdlib>
#include <system_error>

namespace msf {

std::vector<std::filesystem::path> DataFolders() {
  std::vector<std::filesystem::path> folders;
  if (const char* chosen = std::getenv("MSF_SLAM_DATA"); chosen != nullptr && *chosen != '\0')
    folders.emplace_back(chosen);
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  if (!error) folders.push_back(program.parent_path().parent_path() / "share" / "msf_slam");
  folders.emplace_back(MSF_INSTALLED_DATA_FOLDER);
  folders.emplace_back(MSF_SOURCE_DATA_FOLDER);
  return folders;
}

StatusOr<std::filesystem::path> FindDataFile(const std::string& name) {
  std::string searched;
  for (const std::filesystem::path& folder : DataFolders()) {
    const std::filesystem::path file = folder / name;
    std::error_code ignored;
    if (std::filesystem::exists(file, ignored)) return file;
    searched += (searched.empty() ? "" : ", ") + folder.string();
  }
  return Status::Error(fmt::format(
      "'{}' was not found in {}; set MSF_SLAM_DATA to the folder that holds it", name, searched));
}

}  // namespace msf
