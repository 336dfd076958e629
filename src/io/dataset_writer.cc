#include "io/dataset_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <system_error>
#include <utility>

#include "io/png_encoder.h"
#include "io/presence.h"
#include "util/atomic_file.h"
#include "util/options.h"

namespace msf {
namespace fs = std::filesystem;
namespace {

Status SystemError(const fs::path& path, const std::string& what, const std::error_code& error) {
  return Status::Error(fmt::format("{}: {}: {}", path.string(), what, error.message()));
}

// What a data set consists of, besides the marker.
constexpr std::array<std::string_view, 3> kImageFolders = {"rgb", "depth", "mask"};
constexpr std::array<std::string_view, 7> kTextFiles = {
    "rgb.txt",         "depth.txt",   "mask.txt",  "associations.txt",
    "groundtruth.txt", "camera.yaml", "actors.txt"};

// Whether what lies so deep in a data set's folder is a part of it.
bool IsPart(const fs::directory_entry& entry, int depth, const std::string& marker) {
  const auto is_among = [name = entry.path().filename().string()](const auto& names) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  const fs::path kind = entry.path().extension();
  if (IsFolder(entry.path())) return depth == 0 && is_among(kImageFolders);
  if (kind == ".part") return true;  // a run that was killed had begun to write it
  if (depth > 0) return kind == ".png";
  return entry.path().filename() == marker || is_among(kTextFiles);
}

// Whether `folder` may be replaced by a new data set: with it goes all that it holds.
Status CheckReplaceable(const fs::path& folder, const std::string& marker) {
  std::error_code error;
  if (!IsThere(folder)) return Status::Ok();
  if (!IsFolder(folder) || !(fs::is_empty(folder, error) || IsThere(folder / marker))) {
    return Status::Error(
        fmt::format("{}: exists and was not made by this command (it holds no {}); choose another "
                    "folder or remove it",
                    folder.string(), marker));
  }
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (IsPart(*entry, entry.depth(), marker)) continue;
    return Status::Error(
        fmt::format("{}: is no part of the data set that would be replaced; move it away or choose "
                    "another folder",
                    entry->path().string()));
  }
  return error ? SystemError(folder, "cannot be read", error) : Status::Ok();
}

}  // namespace

StatusOr<DatasetWriter> DatasetWriter::Create(const fs::path& folder, const std::string& marker) {
  const fs::path target = ResolvePath(folder);  // ".part" goes beside it, even of a link
  if (target.empty()) return Status::Error("the folder to write to has no name");
  MSF_RETURN_IF_ERROR(CheckReplaceable(target, marker));
  const fs::path part = target.string() + ".part";
  MSF_RETURN_IF_ERROR(CheckReplaceable(part, marker));  // left over from a run that was killed
  std::error_code error;
  fs::remove_all(part, error);
  for (const char* images : {"rgb", "depth"}) {
    fs::create_directories(part / images, error);
    if (error) return SystemError(part / images, "cannot be created", error);
  }
  MSF_RETURN_IF_ERROR(WriteFileAtomically(part / marker, ""));
  return DatasetWriter(target, part, marker);
}

DatasetWriter::DatasetWriter(fs::path folder, fs::path part, std::string marker)
    : folder_(std::move(folder)),
      part_(std::move(part)),
      marker_(std::move(marker)),
      rgb_list_("# color images\n# timestamp filename\n"),
      depth_list_("# depth images\n# timestamp filename\n"),
      associations_("# timestamp rgb timestamp depth\n") {}

DatasetWriter::DatasetWriter(DatasetWriter&& other) noexcept
    : folder_(std::move(other.folder_)),
      part_(std::exchange(other.part_, {})),
      marker_(std::move(other.marker_)),
      camera_yaml_(std::move(other.camera_yaml_)),
      rgb_list_(std::move(other.rgb_list_)),
      depth_list_(std::move(other.depth_list_)),
      mask_list_(std::move(other.mask_list_)),
      associations_(std::move(other.associations_)) {}

DatasetWriter::~DatasetWriter() {
  std::error_code ignored;
  if (!part_.empty()) fs::remove_all(part_, ignored);
}

Status DatasetWriter::AddFrame(const RgbdFrame& frame, const cv::Mat& mask) {
  MSF_RETURN_IF_ERROR(CheckFrame(frame));
  const std::string stamp = fmt::format("{:.6f}", frame.time_s);
  MSF_RETURN_IF_ERROR(WriteImage(frame.color, "rgb", stamp));
  MSF_RETURN_IF_ERROR(WriteImage(frame.depth, "depth", stamp));
  rgb_list_ += fmt::format("{0} rgb/{0}.png\n", stamp);
  depth_list_ += fmt::format("{0} depth/{0}.png\n", stamp);
  associations_ += fmt::format("{0} rgb/{0}.png {0} depth/{0}.png\n", stamp);
  if (camera_yaml_.empty()) camera_yaml_ = YAML::Dump(OptionsToYaml(*frame.camera)) + "\n";
  if (mask.empty()) return Status::Ok();
  if (mask_list_.empty()) {
    std::error_code error;
    fs::create_directory(part_ / "mask", error);
    if (error) return SystemError(part_ / "mask", "cannot be created", error);
    mask_list_ = "# masks: 0 = static, else the number of the moving thing\n# timestamp filename\n";
  }
  mask_list_ += fmt::format("{0} mask/{0}.png\n", stamp);
  return WriteImage(mask, "mask", stamp);
}

Status DatasetWriter::WriteImage(const cv::Mat& image, const std::string& folder,
                                 const std::string& stamp) {
  const std::string name = stamp + ".png";
  return WriteFileAtomically(part_ / folder / name, EncodePng(image));
}

Status DatasetWriter::AddFile(const std::string& name, const std::string& text) {
  return WriteFileAtomically(part_ / name, text);
}

Status DatasetWriter::Finish(const Trajectory& ground_truth) {
  if (camera_yaml_.empty())
    return Status::Error(folder_.string() + ": is left as it is, for there is no frame to write");
  MSF_RETURN_IF_ERROR(AddFile("rgb.txt", rgb_list_));
  MSF_RETURN_IF_ERROR(AddFile("depth.txt", depth_list_));
  MSF_RETURN_IF_ERROR(AddFile("associations.txt", associations_));
  MSF_RETURN_IF_ERROR(AddFile("camera.yaml", camera_yaml_));
  if (!mask_list_.empty()) MSF_RETURN_IF_ERROR(AddFile("mask.txt", mask_list_));
  MSF_RETURN_IF_ERROR(WriteTrajectory(part_ / "groundtruth.txt", ground_truth));
  MSF_RETURN_IF_ERROR(CheckReplaceable(folder_, marker_));  // much may have happened meanwhile
  std::error_code error;
  fs::remove_all(folder_, error);
  if (error) return SystemError(folder_, "the old data set cannot be removed", error);
  fs::rename(part_, folder_, error);
  if (error) return SystemError(folder_, "the finished data set cannot be put there", error);
  part_.clear();
  return Status::Ok();
}

}  // namespace msf
