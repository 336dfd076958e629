#include "detection/detector.h"
#include "util/data_path.h"

namespace msf {
namespace fs = std::filesystem;

StatusOr<fs::path> FindModel(const std::string& name) {
  std::error_code ignored;
  if (fs::is_regular_file(name, ignored)) return fs::path(name);
  std::string searched;
  for (const fs::path& folder : DataFolders()) {
    const fs::path place = folder / "models";
    if (fs::is_regular_file(place / name, ignored)) return place / name;
    searched += (searched.empty() ? "" : ", ") + place.string();
  }
  return Status::Error(
      "there is no model '" + name + "', neither as a file nor in " + searched +
      "; give an ONNX file, or set MSF_SLAM_DATA to the folder that holds models/");
}

}  // namespace msf
