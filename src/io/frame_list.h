// The lists of an RGB-D sequence in TUM layout and how colour finds its depth.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "util/status.h"

namespace msf {

// One line of rgb.txt or depth.txt.
struct ListedImage {
  double time_s = 0;
  std::filesystem::path file;
};

// Colour and depth that belong together.
struct FrameFiles {
  double time_s = 0;  // of the colour image: the frame's time
  double depth_time_s = 0;
  std::filesystem::path color;
  std::filesystem::path depth;
};

// Two images belong together when their time stamps differ by less.
inline constexpr double kMaxColorDepthGap_s = 0.02;

// Reads `timestamp path` lines; paths are relative to the list's folder. Lines that make no sense
// are left out, lines out of order are sorted and repeated time stamps dropped, each with a
// sentence in `warnings`. An error when nothing is left.
StatusOr<std::vector<ListedImage>> ReadImageList(const std::filesystem::path& file,
                                                 std::vector<std::string>& warnings);

// Reads `t_rgb rgb t_depth depth` lines in the same way; stamps that are more than a second apart
// make no sense either.
StatusOr<std::vector<FrameFiles>> ReadAssociations(const std::filesystem::path& file,
                                                   std::vector<std::string>& warnings);

// Pairs each colour image with the depth image nearest in time, nearest pairs first, each image
// used once and no pair kMaxColorDepthGap_s or more apart (the rule of the TUM benchmark's tools).
// Both lists are in order of time, and so is the result.
std::vector<FrameFiles> AssociateByTime(const std::vector<ListedImage>& color,
                                        const std::vector<ListedImage>& depth);

}  // namespace msf
