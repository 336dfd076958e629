#include "viewer/picture_writer.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <system_error>

#include "util/atomic_file.h"

namespace msf {
namespace {

namespace fs = std::filesystem;

// A folder with this file was made here and may be replaced.
constexpr const char* kMarker = ".msf_slam_overlay";

Status CannotWrite(const fs::path& target, const std::string& why) {
  return Status::Error(target.string() + ": the pictures cannot be written there (" + why + ")");
}

Status Rename(const fs::path& part, const fs::path& target) {
  std::error_code error;
  fs::rename(part, target, error);
  return error ? CannotWrite(target, error.message()) : Status::Ok();
}

// A new folder beside the target, which goes with the object unless it was renamed.
class PartFolder {
 public:
  explicit PartFolder(const fs::path& target)
      : path_(fmt::format("{}.{}.part", target.string(), getpid())) {}
  ~PartFolder() {
    std::error_code ignored;
    if (is_ours_) fs::remove_all(path_, ignored);
  }
  PartFolder(const PartFolder&) = delete;
  PartFolder& operator=(const PartFolder&) = delete;

  Status Make() {
    std::error_code error;
    is_ours_ = fs::create_directory(path_, error);
    if (is_ours_) return Status::Ok();
    return CannotWrite(path_, error ? error.message() : "something else is there; remove it");
  }
  fs::path operator/(const std::string& name) const { return path_ / name; }
  const fs::path& path() const { return path_; }

 private:
  const fs::path path_;
  bool is_ours_ = false;
};

class VideoFile : public PictureWriter {
 public:
  VideoFile(const fs::path& target, double fps) : target_(target), part_(target), fps_(fps) {}

  Status Prepare() {
    std::error_code ignored;
    const fs::file_status status = fs::status(target_, ignored);
    if (fs::exists(status) && !fs::is_regular_file(status))
      return CannotWrite(target_, fs::is_directory(status) ? "it is a folder" : "it is no file");
    return part_.Make();
  }

  Status Add(const cv::Mat& picture) override {
    if (!video_.isOpened() && !Open(picture.size()))
      return CannotWrite(target_, "no video encoder works here; name a folder instead");
    video_.write(picture);
    ++num_pictures_;
    return Status::Ok();
  }

  Status Finish() override {
    if (num_pictures_ == 0) return CannotWrite(target_, "no picture was written");
    video_.release();
    // The encoder keeps it to itself when the disk takes no more.
    const cv::VideoCapture written(file_.string(), cv::CAP_FFMPEG);
    const double num_written = written.isOpened() ? written.get(cv::CAP_PROP_FRAME_COUNT) : 0;
    if (num_written != num_pictures_)
      return CannotWrite(target_, "the video is not whole; is the disk full?");
    return Rename(file_, target_);
  }

 private:
  bool Open(cv::Size size) {
    for (const char* codec : {"avc1", "mp4v"}) {
      const int fourcc = cv::VideoWriter::fourcc(codec[0], codec[1], codec[2], codec[3]);
      if (video_.open(file_.string(), cv::CAP_FFMPEG, fourcc, fps_, size)) return true;
    }
    return false;
  }

  const fs::path target_;
  PartFolder part_;
  const fs::path file_ = part_ / "video.mp4";
  const double fps_;
  cv::VideoWriter video_;
  int num_pictures_ = 0;
};

bool IsPicture(const fs::directory_entry& entry) {
  std::error_code ignored;
  const std::string stem = entry.path().stem().string();
  return entry.is_regular_file(ignored) && entry.path().extension() == ".jpg" &&
         std::all_of(stem.begin(), stem.end(),
                     [](unsigned char c) { return std::isdigit(c) != 0; });
}

// Whether `target` may be replaced by a folder of pictures: with it goes all that it holds.
Status CheckReplaceable(const fs::path& target) {
  std::error_code error;
  const fs::file_status status = fs::status(target, error);
  if (status.type() == fs::file_type::not_found) return Status::Ok();
  if (!fs::exists(status)) return CannotWrite(target, error.message());
  if (!fs::is_directory(status))
    return CannotWrite(target, "it is a file; a video's name ends in .mp4");
  bool is_empty = true, has_marker = false, has_others = false;
  for (fs::directory_iterator entry(target, error), end; !error && entry != end;
       entry.increment(error)) {
    const bool is_marker = entry->path().filename() == kMarker;
    is_empty = false;
    has_marker |= is_marker;
    has_others |= !is_marker && !IsPicture(*entry);
  }
  if (error) return CannotWrite(target, error.message());
  if (is_empty || (has_marker && !has_others)) return Status::Ok();
  return CannotWrite(target,
                     "it holds other files than those of an earlier overlay; name a new "
                     "folder, or remove this one");
}

class PictureFolder : public PictureWriter {
 public:
  explicit PictureFolder(const fs::path& target) : target_(target), part_(target) {}

  Status Prepare() {
    MSF_RETURN_IF_ERROR(CheckReplaceable(target_));
    MSF_RETURN_IF_ERROR(part_.Make());
    return WriteFileAtomically(part_ / kMarker, "");
  }

  Status Add(const cv::Mat& picture) override {
    const fs::path file = part_ / fmt::format("{:06d}.jpg", num_pictures_++);
    return cv::imwrite(file.string(), picture) ? Status::Ok()
                                               : CannotWrite(target_, "is the disk full?");
  }

  Status Finish() override {
    MSF_RETURN_IF_ERROR(CheckReplaceable(target_));  // much may have happened meanwhile
    std::error_code error;
    fs::remove_all(target_, error);
    return error ? CannotWrite(target_, error.message()) : Rename(part_.path(), target_);
  }

 private:
  const fs::path target_;
  PartFolder part_;
  int num_pictures_ = 0;
};

}  // namespace

StatusOr<std::unique_ptr<PictureWriter>> PictureWriter::Create(const fs::path& target, double fps) {
  const fs::path path = ResolvePath(target);
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  if (error) return CannotWrite(target, error.message());
  if (path.extension() == ".mp4") {
    auto video = std::make_unique<VideoFile>(path, fps);
    MSF_RETURN_IF_ERROR(video->Prepare());
    return std::unique_ptr<PictureWriter>(std::move(video));
  }
  auto folder = std::make_unique<PictureFolder>(path);
  MSF_RETURN_IF_ERROR(folder->Prepare());
  return std::unique_ptr<PictureWriter>(std::move(folder));
}

}  // namespace msf
