#include "viewer/picture_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <system_error>

namespace msf {
namespace {

namespace fs = std::filesystem;

Status CannotWrite(const fs::path& target, const std::string& why) {
  return Status::Error(target.string() + ": the pictures cannot be written there (" + why + ")");
}

Status Rename(const fs::path& part, const fs::path& target) {
  std::error_code error;
  fs::rename(part, target, error);
  return error ? CannotWrite(target, error.message()) : Status::Ok();
}

class VideoFile : public PictureWriter {
 public:
  VideoFile(fs::path target, double fps)
      : target_(std::move(target)),
        part_(fs::path(target_).replace_extension(".part.mp4")),
        fps_(fps) {}
  ~VideoFile() override {
    video_.release();
    std::error_code ignored;
    fs::remove(part_, ignored);
  }

  // The encoder opens the file with the first picture; whether there can be one is known now.
  Status Prepare() const {
    if (std::ofstream(part_)) return Status::Ok();
    return CannotWrite(target_, std::generic_category().message(errno));
  }

  Status Add(const cv::Mat& picture) override {
    if (!video_.isOpened() && !Open(picture.size()))
      return CannotWrite(target_, "no video encoder works here; name a folder instead");
    video_.write(picture);
    return Status::Ok();
  }

  Status Finish() override {
    video_.release();
    std::error_code error;
    const auto bytes = fs::file_size(part_, error);
    if (error || bytes == 0) return CannotWrite(target_, "no picture was written");
    return Rename(part_, target_);
  }

 private:
  bool Open(cv::Size size) {
    for (const char* codec : {"avc1", "mp4v"}) {
      const int fourcc = cv::VideoWriter::fourcc(codec[0], codec[1], codec[2], codec[3]);
      if (video_.open(part_.string(), cv::CAP_FFMPEG, fourcc, fps_, size)) return true;
    }
    return false;
  }

  const fs::path target_, part_;
  const double fps_;
  cv::VideoWriter video_;
};

bool IsPicture(const fs::path& file) {
  const std::string stem = file.stem().string();
  return file.extension() == ".jpg" && std::all_of(stem.begin(), stem.end(), [](unsigned char c) {
           return std::isdigit(c) != 0;
         });
}

class PictureFolder : public PictureWriter {
 public:
  explicit PictureFolder(const fs::path& target)
      : target_(target), part_(target.string() + ".part") {}
  ~PictureFolder() override {
    std::error_code ignored;
    fs::remove_all(part_, ignored);
  }

  Status Prepare() {
    std::error_code error;
    if (fs::exists(target_) && !fs::is_directory(target_))
      return CannotWrite(target_, "it is a file; a video's name ends in .mp4");
    if (fs::is_directory(target_)) {
      for (const auto& entry : fs::directory_iterator(target_, error)) {
        if (!IsPicture(entry.path()))
          return CannotWrite(target_, "it holds other files; name a new folder");
      }
    }
    fs::remove_all(part_, error);
    fs::create_directories(part_, error);
    return error ? CannotWrite(target_, error.message()) : Status::Ok();
  }

  Status Add(const cv::Mat& picture) override {
    const fs::path file = part_ / fmt::format("{:06d}.jpg", num_pictures_++);
    return cv::imwrite(file.string(), picture) ? Status::Ok()
                                               : CannotWrite(target_, "is the disk full?");
  }

  Status Finish() override {
    std::error_code error;
    fs::remove_all(target_, error);
    return Rename(part_, target_);
  }

 private:
  const fs::path target_, part_;
  int num_pictures_ = 0;
};

}  // namespace

StatusOr<std::unique_ptr<PictureWriter>> PictureWriter::Create(const fs::path& target, double fps) {
  const fs::path path =
      target.has_filename() ? target : target.parent_path();  // "folder/" is "folder"
  std::error_code error;
  if (path.has_parent_path()) fs::create_directories(path.parent_path(), error);
  if (error) return CannotWrite(target, error.message());
  if (path.extension() == ".mp4") {
    if (fs::is_directory(path)) return CannotWrite(target, "it is a folder");
    auto video = std::make_unique<VideoFile>(path, fps);
    MSF_RETURN_IF_ERROR(video->Prepare());
    return std::unique_ptr<PictureWriter>(std::move(video));
  }
  auto folder = std::make_unique<PictureFolder>(path);
  MSF_RETURN_IF_ERROR(folder->Prepare());
  return std::unique_ptr<PictureWriter>(std::move(folder));
}

}  // namespace msf
