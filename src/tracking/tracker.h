// Follows the camera from frame to frame and decides what the map keeps.
#pragma once

#include <memory>

#include "map/shared_map.h"
#include "place_recognition/keyframe_database.h"
#include "place_recognition/vocabulary.h"
#include "tracking/keyframe_policy.h"
#include "tracking/local_map.h"
#include "tracking/pose_tracking.h"
#include "tracking/relocalizer.h"
#include "tracking/tracking_result.h"

namespace msf {

// Single-threaded; shares the map and the keyframe database with mapping and loop closing, which
// may run beside it.
class Tracker {
 public:
  struct Options {
    TrackingOptions tracking;
    RelocalizationOptions relocalization;
    NoiseOptions noise;
    uint64_t seed = 0;
  };
  Tracker(const Options& options, std::shared_ptr<const Camera> camera, const ScaleLevels& levels,
          SharedMap& map, std::shared_ptr<const Vocabulary> vocabulary,
          const KeyFrameDatabase& database);

  // Frames must come in the order of time. `removed`: features that seem to move; they are not
  // used unless the map knows better (TrackingOptions::readmit_probability), and points of the map
  // that look like them are doubted. `load` says how busy the mapper is. `T_now_last`: the motion
  // since the image before, if it was seen: where to look for a camera that does not go on as it
  // did.
  TrackingResult Track(RgbdFramePtr image, std::shared_ptr<const FrameFeatures> features,
                       std::shared_ptr<const FrameFeatures> removed, const MappingLoad& load,
                       const std::optional<Rigid3d>& T_now_last);

  // How the camera will have moved `duration_s` from now if it goes on as it does: takes its
  // coordinates of now to those of then. No motion while the velocity is not known.
  Rigid3d PredictMotion(double duration_s) const;

 private:
  bool StartMap(TrackingResult& result);
  // The frame's pose in the map.
  bool Locate(TrackingResult& result);
  bool LocateByVelocity(TrackingResult& result);
  // Moves removed features that may be static after all to the others; false where there are none.
  bool TakeBackDoubtful();
  // A first pose from the motion model, else the reference keyframe, else relocalisation.
  bool FindPose(TrackingResult& result);
  bool FollowMotion();
  bool FollowReferenceKeyFrame();
  bool RelocalizeFrame();
  // Matches the local map and optimises once more; false when too little of it agrees.
  bool RefineWithLocalMap(TrackingResult& result);
  // What was removed as moving comes back where the map has a static point that looks like it.
  bool ReadmitKnown(int min_inliers, TrackingResult& result);
  // Takes the frame as it came.
  void BeginAnew();
  // Whether rows are exposed one after the other, and that is to be undone.
  bool IsRolling() const;
  // Moves the features to where they would be without a rolling shutter, if the velocity is known.
  void UndoRollingShutterAt(const std::optional<Vector6d>& velocity);
  // Twist per second by the last two poses, and at the present one by these three.
  std::optional<Vector6d> PredictVelocity() const;
  std::optional<Vector6d> MeasureVelocity() const;
  // What this frame says about the points of the map: `expected` ones should be visible.
  void TellMap(const std::vector<MapPointId>& expected, bool tracked);
  void InsertKeyFrameIfWanted(const MappingLoad& load, TrackingResult& result);
  void BecomeKeyFrame(Map& map, TrackingResult& result);
  void UpdateState(bool tracked, TrackingResult& result);
  void RememberFrame(bool tracked, TrackingResult& result);

  const BagOfWords& FrameWords();
  void TakeMatches(const std::vector<PointMatch>& matches);
  // The last frame's pose in the map as it is now, after whatever corrections came since.
  void RefreshLastFrame();

  const Options options_;
  const std::shared_ptr<const Camera> camera_;
  const ScaleLevels levels_;
  const TrackingContext context_;
  SharedMap& map_;
  const std::shared_ptr<const Vocabulary> vocabulary_;
  const KeyFrameDatabase& database_;

  TrackingState state_ = TrackingState::kInitialising;
  Frame frame_;  // the present one
  // Its features and the removed ones where a rolling shutter shows them.
  std::shared_ptr<const FrameFeatures> extracted_, extracted_removed_;
  std::vector<int> taken_back_;  // of the removed ones as they came, those that are used after all
  Frame last_;                   // the last one that had a pose
  std::vector<PointMatch> matches_;
  std::vector<Suspect> suspects_;  // among the removed features; they point into local_map_
  std::optional<Rigid3d>
      velocity_;  // T_cl: last camera to present camera, from one frame to the next
  double velocity_interval_s_ = 0;     // the time between these two
  std::optional<Rigid3d> T_now_last_;  // the motion since the last frame, if it was seen
  LocalMap local_map_;
  uint64_t epoch_ = 0;  // of the map that the frame was located in
  bool last_frame_tracked_ = false;
  double last_keyframe_time_s_ = 0;
  double last_tracked_time_s_ = 0;
  double relocalized_time_s_ = -1e9;
};

}  // namespace msf
