#include "apps/image_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>

#include "io/frame_list.h"
#include "io/presence.h"

namespace msf {
namespace {

namespace fs = std::filesystem;

bool IsImage(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg";
}

StatusOr<std::vector<fs::path>> ImagesInFolder(const fs::path& folder) {
  std::vector<fs::path> images;
  std::error_code failure;
  for (fs::directory_iterator entry(folder, failure), end; !failure && entry != end;
       entry.increment(failure)) {
    if (IsImage(entry->path())) images.push_back(entry->path());
  }
  if (failure) return Status::Error(folder.string() + ": cannot be read: " + failure.message());
  std::sort(images.begin(), images.end());
  return images;
}

StatusOr<std::vector<fs::path>> ImagesOfSequence(const fs::path& folder) {
  std::vector<std::string> warnings;
  std::vector<fs::path> images;
  if (IsThere(folder / "rgb.txt")) {
    auto list = ReadImageList(folder / "rgb.txt", warnings);
    if (!list.ok()) return list.status();
    for (const ListedImage& image : *list) images.push_back(image.file);
  } else {
    auto list = ReadAssociations(folder / "associations.txt", warnings);
    if (!list.ok()) return list.status();
    for (const FrameFiles& frame : *list) images.push_back(frame.color);
  }
  return images;
}

StatusOr<std::vector<fs::path>> AllImages(const fs::path& source) {
  std::error_code ignored;
  if (fs::is_regular_file(source, ignored)) return std::vector<fs::path>{source};
  if (!IsFolder(source))
    return Status::Error(source.string() + ": there is no such image or folder");
  if (IsThere(source / "rgb.txt") || IsThere(source / "associations.txt"))
    return ImagesOfSequence(source);
  if (IsFolder(source / "JPEGImages")) return ImagesInFolder(source / "JPEGImages");
  return ImagesInFolder(source);
}

StatusOr<std::vector<fs::path>> Pick(const std::vector<fs::path>& images,
                                     const fs::path& list_file) {
  const StatusOr<std::map<std::string, fs::path>> by_stem = ImagesByStem(images);
  if (!by_stem.ok()) return by_stem.status();
  std::ifstream list(list_file);
  if (!list)
    return Status::Error(list_file.string() +
                         ": the list of images cannot be read; check the path");
  std::vector<fs::path> picked;
  for (std::string line; std::getline(list, line);) {
    const std::string stem = line.substr(0, line.find_first_of(" \t\r"));
    if (stem.empty()) continue;
    const auto found = by_stem->find(stem);
    if (found == by_stem->end())
      return Status::Error(
          fmt::format("{}: lists '{}', which is not among the images", list_file.string(), stem));
    picked.push_back(found->second);
  }
  return picked;
}

}  // namespace

StatusOr<std::vector<fs::path>> FindImages(const fs::path& source, const fs::path& list_file) {
  StatusOr<std::vector<fs::path>> images = AllImages(source);
  if (images.ok() && !list_file.empty()) images = Pick(*images, list_file);
  if (images.ok() && images->empty()) {
    return Status::Error((list_file.empty() ? source : list_file).string() +
                         ": holds no PNG or JPEG image");
  }
  return images;
}

StatusOr<std::map<std::string, fs::path>> ImagesByStem(const std::vector<fs::path>& images) {
  std::map<std::string, fs::path> by_stem;
  for (const fs::path& image : images) {
    const auto [known, is_new] = by_stem.try_emplace(image.stem().string(), image);
    if (is_new || known->second == image) continue;
    return Status::Error(
        fmt::format("{} and {}: would have one name in the results, '{}'; rename one of them",
                    known->second.string(), image.string(), known->first));
  }
  return by_stem;
}

}  // namespace msf
