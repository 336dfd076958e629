// Which points of an image belong to the static world: detector boxes, depth and motion together.
// Modes and rules: see DynamicOptions.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "dynamic/background.h"
#include "dynamic/background_planes.h"
#include "dynamic/camera_motion.h"
#include "dynamic/object_track.h"
#include "dynamic/point_labels.h"

namespace msf {

// One object as observers see it.
struct DynamicObject {
  int id = 0;
  std::string name;  // of the class; "mover" when it is not known
  ObjectKind kind = ObjectKind::kUnknown;
  MotionState state = MotionState::kMoving;
  bool removed = false;  // its points are not used
  bool bridged = false;  // followed in this image without a detection, and not seen to move
  float score = 0;
  ImageBox box;
  double moving_share = 0;
};

// What the filter says about one frame.
struct DynamicResult {
  PointLabels labels;  // per feature given to Classify()
  std::vector<DynamicObject> objects;
  cv::Mat1b mask;          // cells of CoarseDepth: 255 = removed
  double mask_share = 0;   // of the image
  int detection_age = -1;  // frames between the newest detections and this frame; -1: none yet
  bool camera_motion_reliable = false;
  // The motion since the last frame, where that frame's landmarks tell it.
  std::optional<Rigid3d> T_now_last;
};

// Single-threaded. Frames come in the order of time.
class DynamicFilter {
 public:
  // `class_names`: of the detector whose results Classify() will get; empty without one.
  static StatusOr<std::unique_ptr<DynamicFilter>> Create(
      const DynamicOptions& options, const Camera& camera, const ScaleLevels& levels,
      const std::vector<std::string>& class_names, uint64_t seed);

  // `T_last_now_predicted`: takes coordinates of the camera now to those at the last frame.
  // `detections`: the newest ones, of this frame or of an earlier one; null when there are none
  // yet. Detections that were given before are recognised by their frame.
  DynamicResult Classify(const RgbdFrame& frame, const FrameFeatures& features,
                         const Rigid3d& T_last_now_predicted, const Detections* detections);

  // Where tracking has found the camera for the frame that was classified last; nothing when it is
  // lost. `same_world`: the map was not corrected since the frame before. `landmarks`: what that
  // frame shows of the map's trusted part (may be empty).
  void TakePose(const std::optional<Rigid3d>& T_cw, bool same_world,
                std::vector<Landmark> landmarks);

  // How many times as many points as usual the next image needs so that the static part keeps its
  // budget.
  double FeatureFactor() const;

 private:
  DynamicFilter(const DynamicOptions& options, const Camera& camera, const ScaleLevels& levels,
                ClassRoles roles, uint64_t seed);

  // The frame on its way through the filter.
  struct Work {
    const RgbdFrame& frame;
    const FrameFeatures& features;
    std::vector<int> all;                  // every feature
    BlockVerdicts background;              // against older depth
    cv::Mat1b in_box;                      // blocks inside boxes of objects that may move
    cv::Mat1b on_plane;                    // blocks on large flat surfaces
    PastView view;                         // the frame itself, as later frames will need it
    std::vector<FlowPoint> flow;           // of each feature into the last image
    std::vector<PointMotion> motion;       // against the last image
    std::vector<PointMotion> slow_motion;  // against an older one
    std::vector<Detection> detections;     // in place for this frame
  };

  uint64_t SeedFor(const Work& work) const {
    return seed_ + static_cast<uint64_t>(work.frame.id.value());
  }
  void DropInBoxes(const Work& work, DynamicResult& result) const;
  void DropByRawFlow(const Work& work, DynamicResult& result) const;
  void ClassifyByMotion(Work& work, const Detections* detections,
                        const Rigid3d& T_last_now_predicted, DynamicResult& result);

  void TakeDetections(const Detections& detections, Work& work);
  std::vector<Detection> CarryToNow(const Detections& detections, const PastView& then,
                                    const Work& work) const;
  ImageBox CarryBox(const ImageBox& box, const PastView& then, const Work& work) const;
  std::vector<Eigen::Vector2f> ShiftsSince(const PastView& then, const ImageBox& box,
                                           const ObjectMask& mask, const Eigen::Vector2f& guess,
                                           const Work& work) const;
  void FollowCamera(const Rigid3d& T_last_now_predicted, Work& work, DynamicResult& result);
  CameraMotion MotionByLandmarks(const Rigid3d& T_last_now_predicted, const Work& work) const;
  CameraMotion MotionByFeatures(const Rigid3d& T_last_now_predicted, const Work& work) const;
  void TestMotions(Work& work) const;
  void TestSlowMotions(Work& work) const;
  void MoveTracks(const Work& work);
  void ExcludePlanes(Work& work) const;
  cv::Mat1b BlocksInMasks() const;
  void GrowMasks(const Work& work);
  bool GrowsOverWhatMoves(const ObjectTrack& track, const Work& work) const;
  ObjectMaskOptions MaskOptionsFor(const ObjectTrack& track) const;
  void FindMovers(const Work& work);
  void FindIntruders(const Work& work);
  void GatherEvidence(const Work& work);
  bool IsCredible(const ObjectTrack& track) const;
  double MaskShare(const ObjectTrack& track) const;
  bool CoversImage(const ObjectTrack& track) const;
  cv::Mat1b RememberedCells(const Work& work) const;
  void LabelPoints(const Work& work, DynamicResult& result) const;
  void ReadmitPoints(const Work& work, DynamicResult& result) const;
  float DoubtfulWeight() const;
  void Describe(const Work& work, DynamicResult& result) const;
  cv::Mat1b OwnersOfCells(const Work& work, const DynamicResult& result) const;
  void Remember(Work& work, const DynamicResult& result);
  const PastView* ViewBefore(double time_s) const;
  template <typename Predicate>
  bool WasOn(const Eigen::Vector2f& last_px, Predicate such) const;

  const DynamicOptions options_;
  const Camera camera_;
  const ScaleLevels levels_;
  const uint64_t seed_;
  FlowOptions flow_options_;
  ObjectTracks tracks_;
  std::deque<PastView> past_;  // newest last
  Background background_;
  Vector6d last_velocity_ = Vector6d::Zero();  // twist per second up to the present frame
  bool steady_ = false;                        // the camera turns slowly
  cv::Mat1b last_owners_;                      // CellOwner per cell of the last frame
  std::vector<Landmark> landmarks_;            // of the last frame
  std::optional<Rigid3d> T_cw_last_;           // of the last frame, by tracking
  std::optional<Rigid3d> T_cw_expected_;       // of the present one, by its motion since
  FrameId last_detections_;                    // the frame of the newest detections taken
  double mask_share_ = 0;                      // of the last frame
};

// Features with their static probability as weight, in two parts.
struct SplitFeatures {
  FrameFeatures used;             // static enough
  FrameFeatures removed;          // the others
  std::vector<int> removed_from;  // per removed feature: its index before
};
SplitFeatures SplitByProbability(const FrameFeatures& features, const PointLabels& labels,
                                 double min_static_probability, const Camera& camera);

}  // namespace msf
