// The images that a command works on.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "util/status.h"

namespace msf {

// `source` is an image, a folder of images, a data set in VOC layout (its JPEGImages) or an RGB-D
// sequence in TUM layout (its colour images). `list_file`, unless empty, names the wanted images by
// their stems, one per line (the form of VOC's ImageSets), and gives their order. An empty result
// and a listed image that is not there are errors.
StatusOr<std::vector<std::filesystem::path>> FindImages(const std::filesystem::path& source,
                                                        const std::filesystem::path& list_file);

// The images by their stems, which name them in lists and results; two of the same stem are an
// error that names both.
StatusOr<std::map<std::string, std::filesystem::path>> ImagesByStem(
    const std::vector<std::filesystem::path>& images);

}  // namespace msf
