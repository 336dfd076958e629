#include <cstdlib>

#include "detection/detector.h"

namespace msf {
namespace fs = std::filesystem;

StatusOr<fs::path> FindModel(const std::string& name) {
  std::error_code ignored;
  if (fs::is_regular_file(name, ignored)) return fs::path(name);
  std::vector<fs::path> places;
  if (const char* data = std::getenv("MSF_SLAM_DATA")) places.push_back(fs::path(data) / "models");
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
  if (!program.empty())
    places.push_back(program.parent_path().parent_path() / "share/msf_slam/models");
  places.push_back(fs::path(MSF_SOURCE_DIR) / "models");
  std::string searched;
  for (const fs::path& place : places) {
    if (fs::is_regular_file(place / name, ignored)) return place / name;
    searched += (searched.empty() ? "" : ", ") + place.string();
  }
  return Status::Error(
      "there is no model '" + name + "', neither as a file nor in " + searched +
      "; give an ONNX file, or set MSF_SLAM_DATA to the folder that holds models/");
}

}  // namespace msf
