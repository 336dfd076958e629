#include "io/tum_dataset.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "io/presence.h"
#include "util/options.h"

namespace msf {
namespace {

namespace fs = std::filesystem;

constexpr const char* kAssociations = "associations.txt";
constexpr const char* kCamera = "camera.yaml";

Status CheckSize(const fs::path& file, const cv::Mat& image, const Camera& camera) {
  if (image.cols == camera.width && image.rows == camera.height) return Status::Ok();
  return Status::Error(
      fmt::format("{}: the image has {}x{} pixels, the camera {}x{}; give the camera that took it",
                  file.string(), image.cols, image.rows, camera.width, camera.height));
}

StatusOr<Camera> FindCamera(const fs::path& folder, const std::string& camera) {
  if (!camera.empty()) return ReadCamera(camera);
  const fs::path file = folder / kCamera;
  if (IsThere(file)) return ReadCamera(file.string());
  return Status::Error(
      fmt::format("{}: no {} here, so name the camera with --camera ({}, or a YAML file)",
                  folder.string(), kCamera, fmt::join(Camera::PresetNames(), ", ")));
}

// The frames of a folder by its lists, in order of time.
StatusOr<std::vector<FrameFiles>> ReadLists(const fs::path& folder,
                                            std::vector<std::string>& warnings) {
  if (!IsFolder(folder)) return Status::Error(folder.string() + ": there is no such folder");
  if (IsThere(folder / kAssociations)) return ReadAssociations(folder / kAssociations, warnings);
  if (!IsThere(folder / "rgb.txt") || !IsThere(folder / "depth.txt")) {
    return Status::Error(
        folder.string() +
        ": is no data set in TUM layout: it needs rgb.txt and depth.txt, or associations.txt");
  }
  StatusOr<std::vector<ListedImage>> color = ReadImageList(folder / "rgb.txt", warnings);
  if (!color.ok()) return color.status();
  StatusOr<std::vector<ListedImage>> depth = ReadImageList(folder / "depth.txt", warnings);
  if (!depth.ok()) return depth.status();
  std::vector<FrameFiles> frames = AssociateByTime(*color, *depth);
  if (frames.empty()) {
    return Status::Error(fmt::format("{}: no colour image has a depth image within {} s",
                                     folder.string(), kMaxColorDepthGap_s));
  }
  if (const size_t num_alone = color->size() - frames.size(); num_alone > 0) {
    warnings.push_back(
        fmt::format("{}: {} of {} colour images have no depth image within {} s and are left out",
                    folder.string(), num_alone, color->size(), kMaxColorDepthGap_s));
  }
  return frames;
}

}  // namespace

StatusOr<Camera> ReadCamera(const std::string& name_or_file) {
  std::error_code ignored;
  if (!fs::is_regular_file(name_or_file, ignored)) {
    const bool looks_like_file =
        fs::path(name_or_file).has_parent_path() || fs::path(name_or_file).has_extension();
    if (looks_like_file) return Status::Error(name_or_file + ": there is no such camera file");
    return Camera::Preset(name_or_file);
  }
  Camera camera;
  MSF_RETURN_IF_ERROR(LoadOptions(name_or_file, camera));
  if (const Status status = camera.Check(); !status.ok())
    return Status::Error(name_or_file + ": " + status.message());
  return camera;
}

StatusOr<size_t> CountFrames(const fs::path& folder) {
  std::vector<std::string> warnings;
  StatusOr<std::vector<FrameFiles>> frames = ReadLists(folder, warnings);
  if (!frames.ok()) return frames.status();
  return frames->size();
}

StatusOr<TumDataset> TumDataset::Open(const fs::path& folder, const std::string& camera) {
  TumDataset dataset;
  dataset.folder_ = folder;
  StatusOr<std::vector<FrameFiles>> frames = ReadLists(folder, dataset.warnings_);
  if (!frames.ok()) return frames.status();
  dataset.frames_ = std::move(*frames);
  StatusOr<Camera> found = FindCamera(folder, camera);
  if (!found.ok()) return found.status();
  dataset.camera_ = std::make_shared<const Camera>(*found);
  return dataset;
}

StatusOr<RgbdFramePtr> TumDataset::Load(size_t index) {
  MSF_CHECK(index < frames_.size(), "no such frame");
  const FrameFiles& files = frames_[index];
  StatusOr<cv::Mat> color = reader_.ReadColor(files.color);
  if (!color.ok()) return color.status();
  MSF_RETURN_IF_ERROR(CheckSize(files.color, *color, *camera_));
  StatusOr<cv::Mat> depth = reader_.ReadDepth(files.depth);
  if (!depth.ok()) return depth.status();
  MSF_RETURN_IF_ERROR(CheckSize(files.depth, *depth, *camera_));
  auto frame = std::make_shared<RgbdFrame>();
  frame->id = FrameId(static_cast<int64_t>(index));
  frame->time_s = files.time_s;
  frame->depth_delay_s = files.depth_time_s - files.time_s;
  frame->color = std::move(*color);
  frame->depth = std::move(*depth);
  frame->camera = camera_;
  return RgbdFramePtr(std::move(frame));
}

std::optional<fs::path> TumDataset::ground_truth_file() const {
  const fs::path file = folder_ / "groundtruth.txt";
  return IsThere(file) ? std::optional(file) : std::nullopt;
}

}  // namespace msf
