// RGB-D sequences in TUM layout (the Bonn data set is the same).
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/frame_list.h"
#include "io/image_reader.h"
#include "sensor/rgbd_frame.h"
#include "util/status.h"

namespace msf {

// The camera that `name_or_file` means: a preset's name or a YAML file with the keys of Camera.
StatusOr<Camera> ReadCamera(const std::string& name_or_file);

// The number of frames in a data set's folder, whatever its camera is.
StatusOr<size_t> CountFrames(const std::filesystem::path& folder);

// A folder with rgb.txt and depth.txt, or associations.txt (which is preferred). Opening reads the
// lists only. Used by one thread at a time.
class TumDataset {
 public:
  // `camera`: see ReadCamera; when empty the folder must hold a camera.yaml. Errors: no data set
  // there, unreadable or empty lists, no pair of colour and depth, no camera. What could be
  // survived in the lists is told by warnings().
  static StatusOr<TumDataset> Open(const std::filesystem::path& folder,
                                   const std::string& camera = "");

  size_t size() const { return frames_.size(); }
  const FrameFiles& files(size_t index) const { return frames_[index]; }
  double time_s(size_t index) const { return frames_[index].time_s; }
  const Camera& camera() const { return *camera_; }
  const std::filesystem::path& folder() const { return folder_; }

  // Reads the images of frame `index`; the frame's id is its index. An error (missing or damaged
  // file, wrong size, wrong type) concerns this frame only: the next one may well be fine.
  StatusOr<RgbdFramePtr> Load(size_t index);

  // groundtruth.txt when the folder has one.
  std::optional<std::filesystem::path> ground_truth_file() const;

  // One sentence for each kind of flaw that was survived while opening.
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  TumDataset() = default;

  std::filesystem::path folder_;
  std::shared_ptr<const Camera> camera_;
  std::vector<FrameFiles> frames_;
  std::vector<std::string> warnings_;
  ImageReader reader_;
};

}  // namespace msf
