#include "evaluation/mask_score.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <system_error>

#include "io/image_reader.h"
#include "io/presence.h"
#include "io/text_rows.h"

namespace msf {
namespace {

namespace fs = std::filesystem;

constexpr double kSameTime_s = 1e-4;

// Names of files and rows of actors.txt by time stamp.
template <typename T>
const T* FindByTime(const std::map<double, T>& by_time, double time_s) {
  const auto found = by_time.lower_bound(time_s - kSameTime_s);
  return found != by_time.end() && found->first <= time_s + kSameTime_s ? &found->second : nullptr;
}

// 0 static, 1 on a mover, 2 near the border between them.
cv::Mat1b MarkBorder(const cv::Mat& mask) {
  cv::Mat1b movers, grown, shrunk;
  cv::compare(mask, 0, movers, cv::CMP_NE);
  const int side = 2 * kMaskBorder_px + 1;
  const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, {side, side});
  cv::dilate(movers, grown, disc);
  cv::erode(movers, shrunk, disc);  // what is outside the image takes nothing away
  cv::Mat1b marked(mask.size(), static_cast<uint8_t>(0));
  marked.setTo(2, grown);
  marked.setTo(1, shrunk);
  return marked;
}

int SizeClassOf(double visible_share) {
  const auto above = std::upper_bound(kActorSizes.begin(), kActorSizes.end(), visible_share);
  return static_cast<int>(above - kActorSizes.begin()) - 1;
}

ActorTally& TallyOf(const std::string& class_name, int size_class, MaskScore& score) {
  const auto is_before = [](const ActorTally& a, const std::pair<std::string, int>& b) {
    return std::pair(a.class_name, a.size_class) < b;
  };
  const std::pair wanted(class_name, size_class);
  auto place = std::lower_bound(score.actors.begin(), score.actors.end(), wanted, is_before);
  if (place == score.actors.end() || std::pair(place->class_name, place->size_class) != wanted)
    place = score.actors.insert(place, {.class_name = class_name, .size_class = size_class});
  return *place;
}

void CountActors(const LabelledFrame& frame, const cv::Mat& mask,
                 const std::vector<TrueActor>& actors, MaskScore& score) {
  for (const TrueActor& actor : actors) {
    const double share = actor.visible_px / static_cast<double>(mask.total());
    ActorTally& tally = TallyOf(actor.class_name, SizeClassOf(share), score);
    ++tally.visible;
    bool detected = false, followed = false;
    for (const LabelledObject& object : frame.objects) {
      if (IntersectionOverUnion(object.box, actor.box) < kSameObjectIou) continue;
      followed = true;
      detected = detected || !object.bridged;
    }
    tally.detected += detected;
    tally.followed += followed;
  }
}

StatusOr<std::map<double, fs::path>> ListMasks(const fs::path& folder) {
  const fs::path inner = IsFolder(folder / "mask") ? folder / "mask" : folder;
  if (!IsFolder(inner))
    return Status::Error(folder.string() + ": there is no such folder of masks");
  std::map<double, fs::path> masks;
  std::error_code error;
  for (fs::directory_iterator entry(inner, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::optional<double> time_s = ParseFiniteNumber(entry->path().stem().string());
    if (entry->path().extension() == ".png" && time_s) masks[*time_s] = entry->path();
  }
  if (error) return Status::Error(inner.string() + ": cannot be read: " + error.message());
  if (masks.empty()) return Status::Error(inner.string() + ": holds no masks (TIME.png)");
  return masks;
}

// Files of one bit per pixel are read as colour.
StatusOr<cv::Mat> ReadMask(const fs::path& file, ImageReader& reader) {
  StatusOr<cv::Mat> image = reader.ReadColor(file);
  if (!image.ok() || image->channels() == 1) return image;
  std::vector<cv::Mat> channels;
  cv::split(*image, channels);
  cv::Mat mask = channels[0];
  for (const cv::Mat& channel : channels) cv::max(mask, channel, mask);
  return mask;
}

// Both forms there are, told apart by the number of columns of the first line:
//   timestamp actor class visible_px x0 y0 x1 y1
//   timestamp actor clip sprite_frame x0 y0 x1 y1 visible_px ... (people only; actor -1 = nobody)
StatusOr<std::map<double, std::vector<TrueActor>>> ReadActors(const fs::path& file) {
  std::map<double, std::vector<TrueActor>> actors;
  const StatusOr<std::vector<TextRow>> rows = ReadTextRows(file);
  if (!rows.ok()) return rows.status();
  const size_t num_columns = rows->empty() ? 0 : rows->front().columns.size();
  const bool people_only = num_columns > 8;
  for (const auto& [line, columns] : *rows) {
    if (columns.size() < 8) return RowError(file, line, "has fewer than 8 columns");
    if (columns.size() != num_columns) {
      return RowError(file, line,
                      fmt::format("has {} columns, the first line {}; names must hold no blanks",
                                  columns.size(), num_columns));
    }
    // time, x0, y0, x1, y1, visible_px; the last one is looked at only: no part of a name.
    std::array<double, 7> numbers{};
    const std::array<size_t, 7> places = {0, 4, 5, 6, 7, people_only ? size_t{8} : size_t{3}, 3};
    for (size_t i = 0; i < places.size(); ++i) {
      const std::optional<double> number = ParseFiniteNumber(columns[places[i]]);
      if (!number) return RowError(file, line, "'" + columns[places[i]] + "' is no number");
      numbers[i] = *number;
    }
    std::vector<TrueActor>& present = actors[numbers[0]];
    if (columns[1] == "-1" || numbers[5] <= 0) continue;
    const ImageBox box = {static_cast<float>(numbers[1]), static_cast<float>(numbers[2]),
                          static_cast<float>(numbers[3] + 1), static_cast<float>(numbers[4] + 1)};
    present.push_back({people_only ? "person" : columns[2], box, numbers[5]});
  }
  return actors;
}

// Pixels have their centres at whole numbers, so an image begins half a pixel before the first.
bool IsInside(const LabelledPoint& point, const cv::Mat& mask) {
  return point.x_px >= -0.5f && point.y_px >= -0.5f &&
         point.x_px <= static_cast<float>(mask.cols) - 0.5f &&
         point.y_px <= static_cast<float>(mask.rows) - 0.5f;
}

Status CheckSize(const fs::path& labels_file, const LabelledFrame& frame, const fs::path& mask_file,
                 const cv::Mat& mask) {
  for (const LabelledPoint& point : frame.points) {
    if (IsInside(point, mask)) continue;
    return Status::Error(fmt::format(
        "{}: the point ({}, {}) of frame {} lies outside the mask {} of {}x{} pixels; give the "
        "masks that belong to the images of this run",
        labels_file.string(), point.x_px, point.y_px, frame.frame, mask_file.string(), mask.cols,
        mask.rows));
  }
  return Status::Ok();
}

StatusOr<std::map<double, std::vector<TrueActor>>> FindActors(const fs::path& folder) {
  for (const fs::path& file :
       {folder / "actors.txt", folder.lexically_normal() / ".." / "actors.txt"}) {
    if (IsThere(file)) return ReadActors(file);
  }
  return std::map<double, std::vector<TrueActor>>();
}

}  // namespace

int64_t PointTally::Total() const {
  return std::accumulate(by_reason.begin(), by_reason.end(), int64_t{0});
}

int64_t PointTally::Removed() const {
  int64_t removed = 0;
  for (const PointReason reason :
       {PointReason::kBox, PointReason::kObject, PointReason::kFlow, PointReason::kDepth})
    removed += by_reason[static_cast<size_t>(reason)];
  return removed;
}

double PointTally::Share(PointReason reason) const {
  const int64_t total = Total();
  return total == 0 ? 0
                    : static_cast<double>(by_reason[static_cast<size_t>(reason)]) /
                          static_cast<double>(total);
}

double PointTally::RemovedShare() const {
  const int64_t total = Total();
  return total == 0 ? 0 : static_cast<double>(Removed()) / static_cast<double>(total);
}

double MaskScore::Precision() const {
  const int64_t removed = on_movers.Removed() + on_static.Removed();
  return removed == 0 ? 0 : static_cast<double>(on_movers.Removed()) / static_cast<double>(removed);
}

void AddToScore(const LabelledFrame& frame, const cv::Mat& mask,
                const std::vector<TrueActor>& actors, MaskScore& score) {
  ++score.num_frames;
  const cv::Mat1b marked = MarkBorder(mask);
  for (const LabelledPoint& point : frame.points) {
    const int x = std::clamp(static_cast<int>(std::lround(point.x_px)), 0, mask.cols - 1);
    const int y = std::clamp(static_cast<int>(std::lround(point.y_px)), 0, mask.rows - 1);
    const uint8_t side = marked(y, x);
    if (side == 2) {
      ++score.near_border;
    } else {
      (side == 1 ? score.on_movers : score.on_static).Add(point.reason);
    }
  }
  CountActors(frame, mask, actors, score);
}

StatusOr<MaskScore> ScoreAgainstMasks(const std::string& name, const fs::path& labels_file,
                                      const fs::path& folder) {
  const StatusOr<std::map<double, fs::path>> masks = ListMasks(folder);
  if (!masks.ok()) return masks.status();
  const StatusOr<std::map<double, std::vector<TrueActor>>> actors = FindActors(folder);
  if (!actors.ok()) return actors.status();
  const StatusOr<std::vector<LabelledFrame>> frames = ReadLabels(labels_file);
  if (!frames.ok()) return frames.status();
  MaskScore score;
  score.name = name;
  ImageReader reader;
  for (const LabelledFrame& frame : *frames) {
    const fs::path* file = FindByTime(*masks, frame.time_s);
    if (file == nullptr) {
      ++score.num_frames_without_mask;
      continue;
    }
    const StatusOr<cv::Mat> mask = ReadMask(*file, reader);
    if (!mask.ok()) return mask.status();
    MSF_RETURN_IF_ERROR(CheckSize(labels_file, frame, *file, *mask));
    const std::vector<TrueActor>* present = FindByTime(*actors, frame.time_s);
    AddToScore(frame, *mask, present != nullptr ? *present : std::vector<TrueActor>(), score);
  }
  if (score.num_frames == 0) {
    return Status::Error(labels_file.string() + " and the masks in " + folder.string() +
                         " have no time stamp in common");
  }
  return score;
}

}  // namespace msf
