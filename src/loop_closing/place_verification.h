// Whether two keyframes look at one place, and from where: geometry has the last word on what
// looks alike. A wrong answer ruins a map while a missed one costs little, so every step must pass.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "loop_closing/loop_closing_options.h"
#include "loop_closing/place_window.h"
#include "optimization/feature_observation.h"

namespace msf {

// The step at which a comparison ended.
enum class PlaceVerdict {
  kAccepted,
  kFewWordMatches,
  kNoAlignment,       // no rigid motion explains enough matches
  kFewGuidedMatches,  // too few of the window's points are where that motion puts them
  kNotRefinable,      // they do not agree on one pose
  kDepthDisagrees,    // points lie in the right direction at wrong distances
  kFewTightMatches,   // too few agree with the refined pose
  kTooLittleSeen,     // too many of the points that should be visible are not
  kTooMuchDrift,      // no camera path can have drifted so far
};

const char* ToString(PlaceVerdict verdict);

// Where the present keyframe is as the matched place sees it.
struct PlaceMatch {
  PlaceVerdict verdict = PlaceVerdict::kFewWordMatches;
  KeyFrameId current;
  KeyFrameId matched;  // the centre of the matched window
  Rigid3d T_c_m;       // matched camera to current camera
  // Features of the current keyframe and the matched window's points that they show.
  std::vector<std::pair<int, MapPointId>> matches;

  bool accepted() const { return verdict == PlaceVerdict::kAccepted; }
};

// Compares places of one camera. Stateless; valid as long as what it was made from.
class PlaceVerifier {
 public:
  PlaceVerifier(const Camera& camera, const ScaleLevels& levels,
                const PlaceVerificationOptions& options, const PoseOptimizerOptions& pose,
                const NoiseOptions& noise)
      : camera_(camera), levels_(levels), options_(options), pose_(pose), noise_(noise) {}

  // Compares the current window's centre with the matched window: by words, then RANSAC on SE(3),
  // then guided projection of the window's points, pose refinement, and a tighter projection.
  // `seed` makes RANSAC repeatable.
  PlaceMatch Verify(const PlaceWindow& current, const PlaceWindow& matched, uint64_t seed) const;

  // The same from a known motion instead of words, for a keyframe that follows an accepted one.
  PlaceMatch VerifyFrom(const Rigid3d& T_c_m, const KeyFrameView& current,
                        const PlaceWindow& matched) const;

  // The neighbours in the current window that see the matched points where `match` puts them, as
  // a match each.
  std::vector<PlaceMatch> AgreeingNeighbours(const PlaceMatch& match, const PlaceWindow& current,
                                             const PlaceWindow& matched) const;

 private:
  using Matches = std::vector<std::pair<int, MapPointId>>;
  struct WordMatch {
    int feature = -1;       // of the current keyframe
    MapPointId point;       // of the matched window
    double sigma2_px2 = 0;  // of the matched side's feature
    int distance = 0;
  };
  struct Search {
    double radius_px;
    int max_distance;
  };
  struct Found {
    Matches matches;         // those whose depth, if any, agrees
    int num_visible = 0;     // points that project into the image
    int num_deep = 0;        // found by place and descriptor at a feature with depth
    int num_deep_right = 0;  // of these, at the right depth
  };
  std::vector<WordMatch> MatchWords(const KeyFrameView& current, const PlaceWindow& matched) const;
  std::optional<Rigid3d> Align(const std::vector<WordMatch>& words, const PlaceWindow& current,
                               const PlaceWindow& matched, uint64_t seed) const;
  // Looks for the matched window's points in `view`, were it at T_cw in their world.
  Found Project(const KeyFrameView& view, const Rigid3d& T_cw, const PlaceWindow& matched,
                const Search& search) const;
  bool DepthAgrees(const FrameFeatures& features, int feature, double disparity_px) const;
  // Moves T_cw to where the matches agree best and drops those that do not.
  void Refine(const KeyFrameView& view, const PlaceWindow& matched, Matches& matches,
              Rigid3d& T_cw) const;
  PlaceVerdict Confirm(const KeyFrameView& view, const PlaceWindow& matched, int min_guided,
                       int min_tight, Rigid3d& T_cw, Matches& matches) const;

  const Camera& camera_;
  const ScaleLevels& levels_;
  const PlaceVerificationOptions& options_;
  const PoseOptimizerOptions& pose_;
  const NoiseOptions& noise_;
};

}  // namespace msf
