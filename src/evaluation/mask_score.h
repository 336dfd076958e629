// The filter of dynamic points against true masks of what moves.
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "evaluation/label_files.h"

namespace msf {

// A true mover in one frame.
struct TrueActor {
  std::string class_name;
  ImageBox box;
  double visible_px = 0;
};

// Points by PointReason. Removed are those of box, object, flow and depth: they are not used.
// Settled and readmitted points are used with little weight; they count as neither removed nor
// fully kept, but for KeptShare, which says what is used at all. Known points are used like static
// ones.
struct PointTally {
  std::array<int64_t, kNumPointReasons> by_reason{};

  void Add(PointReason reason) { ++by_reason[static_cast<size_t>(reason)]; }
  int64_t Total() const;
  int64_t Removed() const;
  // All of 0..1, 0 without points.
  double Share(PointReason reason) const;
  double RemovedShare() const;
  double KeptShare() const { return Total() == 0 ? 0 : 1 - RemovedShare(); }
};

// Movers of one class and size.
struct ActorTally {
  std::string class_name;
  int size_class = 0;  // index into kActorSizes
  int64_t visible = 0;
  int64_t detected = 0;  // in the newest detections
  int64_t followed = 0;  // detected, or carried on from earlier ones
};

// Sizes of movers: visible share of the image from `kActorSizes[i]` up to the next one.
inline constexpr std::array<double, 5> kActorSizes = {0, 0.005, 0.02, 0.1, 0.3};

struct MaskScore {
  std::string name;
  size_t num_frames = 0;
  size_t num_frames_without_mask = 0;  // not scored
  PointTally on_movers, on_static;
  int64_t near_border = 0;         // points in neither, see kMaskBorder_px
  std::vector<ActorTally> actors;  // by class, then size

  // Of the removed points, those that lie on movers.
  double Precision() const;
  // Of the points on movers, those that were removed.
  double Recall() const { return on_movers.RemovedShare(); }
};

// Points so close to the border of a mask belong to neither side: masks and features are no better
// than that.
inline constexpr int kMaskBorder_px = 4;
// Overlap of a true box and an object's box that makes them the same.
inline constexpr float kSameObjectIou = 0.5f;

// Adds one frame. `mask`: 8-bit, 0 = static; of the size of the images.
void AddToScore(const LabelledFrame& frame, const cv::Mat& mask,
                const std::vector<TrueActor>& actors, MaskScore& score);

// Scores a run's labels.csv against `folder`: PNG masks named by time stamp, or a data set's folder
// with mask/ in it. An actors.txt in the folder or beside it tells the boxes of the movers.
StatusOr<MaskScore> ScoreAgainstMasks(const std::string& name,
                                      const std::filesystem::path& labels_file,
                                      const std::filesystem::path& folder);

std::string FormatMaskScore(const MaskScore& score);
nlohmann::json MaskScoreToJson(const MaskScore& score);

}  // namespace msf
