// Writes an RGB-D sequence as a folder in TUM layout that appears only when it is complete.
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "io/trajectory.h"
#include "sensor/rgbd_frame.h"
#include "util/status.h"

namespace msf {

// The folder:
//   rgb/TIME.png, depth/TIME.png  8-bit BGR and 16-bit depth, listed in rgb.txt and depth.txt
//   mask/TIME.png                 8-bit masks of the frames that have one, listed in mask.txt
//   associations.txt              rgb and depth that belong together
//   groundtruth.txt               TUM trajectory
//   camera.yaml                   the camera, with the keys of Camera
//   actors.txt, the marker        texts of the command that writes it (AddFile)
// All is written to FOLDER.part and renamed at the end.
class DatasetWriter {
 public:
  // `marker`: a file name that every folder written by the same command holds. An existing `folder`
  // is replaced in the end when it is empty, or holds the marker and nothing but a data set; else
  // this is an error.
  static StatusOr<DatasetWriter> Create(const std::filesystem::path& folder,
                                        const std::string& marker);
  DatasetWriter(DatasetWriter&& other) noexcept;
  DatasetWriter& operator=(DatasetWriter&&) = delete;
  // Removes what was written when Finish() did not succeed.
  ~DatasetWriter();

  // Adds a frame; an empty `mask` means none. Time stamps must rise. Errors name the file and the
  // reason (disk full, ...).
  Status AddFrame(const RgbdFrame& frame, const cv::Mat& mask = {});
  // Adds a text file: actors.txt or the marker.
  Status AddFile(const std::string& name, const std::string& text);
  // Writes lists, camera and trajectory, and puts the folder in its place. An error without frames.
  Status Finish(const Trajectory& ground_truth);

 private:
  DatasetWriter(std::filesystem::path folder, std::filesystem::path part, std::string marker);
  Status WriteImage(const cv::Mat& image, const std::string& folder, const std::string& stamp);

  std::filesystem::path folder_;
  std::filesystem::path part_;
  std::string marker_;
  std::string camera_yaml_;
  std::string rgb_list_, depth_list_, mask_list_, associations_;
};

}  // namespace msf
