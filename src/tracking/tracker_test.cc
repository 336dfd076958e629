#include "tracking/tracker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <set>

#include "map/test_world.h"
#include "place_recognition/vocabulary_training.h"

namespace msf {
namespace {

constexpr double kFrame_s = 1.0 / 30;

// A camera that goes round inside the ring of landmarks: tracking alone, without a mapper.
class Trip {
 public:
  explicit Trip(const TrackingOptions& options, double rolling_shutter_s = 0)
      : world_(1, 5000, rolling_shutter_s),
        map_(Map(world_.camera(), world_.levels())),
        vocabulary_(Words(world_)),
        tracker_(With(options), world_.camera(), world_.levels(), map_, vocabulary_, database_) {}

  // The next image, in which the camera turns at `rad_per_s`. Features for which `seems_to_move`
  // (by their place) are removed with the given static probability.
  using Suspicion = std::function<bool(const Eigen::Vector2f& px)>;
  TrackingResult Go(double rad_per_s, const Suspicion& seems_to_move = {},
                    float probability = 0.15f, float shift_px = 0) {
    return Jump(rad_per_s * kFrame_s, rad_per_s, seems_to_move, probability, shift_px);
  }
  // The same by `step_rad`, whatever the velocity at which the rows are exposed. `T_now_last`: the
  // motion as it was seen.
  TrackingResult Jump(double step_rad, double rad_per_s = 0, const Suspicion& seems_to_move = {},
                      float probability = 0.15f, float shift_px = 0,
                      const std::optional<Rigid3d>& T_now_last = std::nullopt) {
    angle_rad_ += step_rad;
    const TestWorld::View view =
        world_.Look(TestWorld::PoseOnCircle(angle_rad_), VelocityAt(rad_per_s));
    FrameFeatures used, removed;
    for (int i = 0; i < view.features->size(); ++i) {
      if (!seems_to_move || !seems_to_move(view.features->uv_px[i])) {
        used.Append(*view.features, i, 1);
        continue;
      }
      removed.Append(*view.features, i, probability);
      removed.uv_px.back().x() += shift_px;
      removed.u_right_px.back() += shift_px;
    }
    used.BuildGrid(*world_.camera());
    removed.BuildGrid(*world_.camera());
    num_removed_ = removed.size();
    RgbdFrame image;
    image.id = FrameId(num_frames_);
    image.time_s = num_frames_++ * kFrame_s;
    image.camera = world_.camera();
    image.color = cv::Mat::zeros(image.camera->height, image.camera->width, CV_8U);
    return tracker_.Track(std::make_shared<const RgbdFrame>(image),
                          std::make_shared<const FrameFeatures>(used),
                          std::make_shared<const FrameFeatures>(removed), {}, T_now_last);
  }
  // The camera turns on, but its image is lost.
  void Skip(double rad_per_s) {
    angle_rad_ += rad_per_s * kFrame_s;
    ++num_frames_;
  }
  // How far the camera is from where the first frame's pose and its path put it, m.
  double Error(const TrackingResult& result) const {
    if (!result.T_cw) return 1e9;
    const Rigid3d T_c_first =
        TestWorld::PoseOnCircle(angle_rad_) * TestWorld::PoseOnCircle(0).Inverse();
    return (result.T_cw->Inverse().translation() - T_c_first.Inverse().translation()).norm();
  }
  int num_removed() const { return num_removed_; }
  float LeastStaticProbability() const {
    float least = 1;
    const SharedMap::Reader map = map_.Read();
    for (const MapPointId id : map->PointIds(map->active_map()))
      least = std::min(least, map->FindPoint(id)->static_weight);
    return least;
  }

 private:
  static Tracker::Options With(const TrackingOptions& tracking) {
    Tracker::Options options;
    options.tracking = tracking;
    return options;
  }
  static Vector6d VelocityAt(double rad_per_s) {
    const Rigid3d T_later_now =
        TestWorld::PoseOnCircle(rad_per_s * kFrame_s) * TestWorld::PoseOnCircle(0).Inverse();
    return T_later_now.Log() / kFrame_s;
  }
  static std::shared_ptr<const Vocabulary> Words(TestWorld& world) {
    std::vector<std::vector<Descriptor>> images;
    for (const double angle_rad : {0.0, 0.4, 0.8})
      images.push_back(world.Look(TestWorld::PoseOnCircle(angle_rad)).features->descriptors);
    return std::make_shared<const Vocabulary>(
        *TrainVocabulary(images, {.branching = 8, .levels = 3}, {}));
  }

  TestWorld world_;
  SharedMap map_;
  const std::shared_ptr<const Vocabulary> vocabulary_;
  const KeyFrameDatabase database_;
  Tracker tracker_;
  double angle_rad_ = 0;
  int num_frames_ = 0;
  int num_removed_ = 0;
};

bool InLeftThird(const Eigen::Vector2f& px) { return px.x() < 213; }

// Of a camera that turns to and fro, on average, m.
double ErrorWhenShaken(bool undo_rolling_shutter, double rolling_shutter_s,
                       double velocity_trend = TrackingOptions().velocity_trend) {
  TrackingOptions options;
  options.undo_rolling_shutter = undo_rolling_shutter;
  options.velocity_trend = velocity_trend;
  Trip trip(options, rolling_shutter_s);
  constexpr int kFrames = 60;
  double sum_m = 0;
  for (int i = 0; i < kFrames; ++i) {
    const TrackingResult result = trip.Go(0.4 * std::sin(0.3 * i));
    EXPECT_EQ(result.state, TrackingState::kTracking) << i;
    sum_m += trip.Error(result);
  }
  return sum_m / kFrames;
}

TEST(Tracker, FollowsAMovingCamera) { EXPECT_LT(ErrorWhenShaken(true, 0), 0.003); }

TEST(Tracker, ARollingShutterCostsNothingOnceItIsUndone) {
  const double undone_m = ErrorWhenShaken(true, 0.023);
  EXPECT_LT(undone_m, 0.003);
  EXPECT_GT(ErrorWhenShaken(false, 0.023), 3 * undone_m);
}

TEST(Tracker, TheTrendOfTheVelocityGoesOnUntilTheExposure) {
  const double mean_m = ErrorWhenShaken(true, 0.023, 0), half_m = ErrorWhenShaken(true, 0.023, 0.5);
  EXPECT_LT(half_m, mean_m);
}

// Twice as far at the velocity so far: neither words nor relocalisation help here.
TEST(Tracker, AMissingFrameIsMadeUpForByTheVelocity) {
  constexpr double kFastest_rad_per_s =
      2.4;  // 42 px per frame, farther than matches are looked for
  TrackingOptions options;
  options.min_reference_matches = 100000;
  Trip trip(options);
  for (double rad_per_s = 0; rad_per_s < kFastest_rad_per_s; rad_per_s += 0.3)
    ASSERT_TRUE(trip.Go(rad_per_s).T_cw) << rad_per_s;
  ASSERT_TRUE(trip.Go(kFastest_rad_per_s).T_cw);
  trip.Skip(kFastest_rad_per_s);
  EXPECT_LT(trip.Error(trip.Go(kFastest_rad_per_s)), 0.01);
}

TEST(Tracker, RemovedFeaturesComeBackWhereTheMapKnowsBetter) {
  Trip trip({});
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(trip.Go(0.1).readmitted.empty());
  const TrackingResult result = trip.Go(0.1, InLeftThird);
  EXPECT_GT(result.readmitted.size(), trip.num_removed() / 2u);
  EXPECT_EQ(std::set<int>(result.readmitted.begin(), result.readmitted.end()).size(),
            result.readmitted.size());
  EXPECT_LT(*std::max_element(result.readmitted.begin(), result.readmitted.end()),
            trip.num_removed());
  EXPECT_GT(result.num_inliers, result.num_features) << "features are those given as static";
  EXPECT_GT(trip.LeastStaticProbability(), 0.99f);
}

TEST(Tracker, FeaturesThatSurelyMoveStayAwayAndTheirPointsAreDoubted) {
  Trip trip({});
  for (int i = 0; i < 5; ++i) trip.Go(0.1);
  EXPECT_TRUE(trip.Go(0.1, InLeftThird, 0.05f).readmitted.empty());
  EXPECT_LT(trip.LeastStaticProbability(), 0.99f);
}

TEST(Tracker, RemovedFeaturesThatAreElsewhereStayAway) {
  Trip trip({});
  for (int i = 0; i < 5; ++i) trip.Go(0.1);
  const TrackingResult result = trip.Go(0.1, InLeftThird, 0.15f, 12);
  EXPECT_LT(result.readmitted.size(), trip.num_removed() / 20u);
  EXPECT_LT(trip.Error(result), 0.01);
}

TEST(Tracker, AMotionThatWasSeenHelpsWhereTheCameraDoesNotGoOnAsItDid) {
  constexpr double kJump_rad = 0.2;
  TrackingOptions without_words;
  without_words.min_reference_matches = 1000000;
  const Rigid3d T_now_last =
      TestWorld::PoseOnCircle(kJump_rad) * TestWorld::PoseOnCircle(0).Inverse();
  for (const bool seen : {false, true}) {
    Trip trip(without_words);
    for (int i = 0; i < 10; ++i) trip.Go(0.1);
    const TrackingResult result =
        trip.Jump(kJump_rad, 0, {}, 0, 0, seen ? std::optional(T_now_last) : std::nullopt);
    EXPECT_EQ(result.T_cw.has_value(), seen);
    if (seen) EXPECT_LT(trip.Error(result), 0.02);
  }
}

TEST(Tracker, RatherThanLosingTrackWhatMayBeStaticIsUsed) {
  const auto almost_everywhere = [](const Eigen::Vector2f& px) { return px.x() > 20; };
  for (const float probability : {0.05f, 0.15f}) {
    Trip trip({});
    for (int i = 0; i < 5; ++i) trip.Go(0.1);
    const TrackingResult result = trip.Go(0.1, almost_everywhere, probability);
    const bool may_be_static = probability > 0.1f;
    EXPECT_EQ(result.T_cw.has_value(), may_be_static);
    EXPECT_EQ(result.readmitted.size(), may_be_static ? trip.num_removed() : 0u);
    if (may_be_static) EXPECT_LT(trip.Error(result), 0.01);
  }
}

TEST(Tracker, ShowsLandmarksOnceTheMapIsOldEnough) {
  Trip trip({});
  double time_s = 0;
  for (TrackingResult result = trip.Go(0.1); time_s < 1.5; result = trip.Go(0.1)) {
    time_s = result.time_s;
    EXPECT_EQ(result.landmarks.empty(), time_s < 1) << time_s;
  }
}

TEST(TrackingOptions, RefuseLandmarksThatCannotBe) {
  const auto accepts = [](double age_s, int count) {
    TrackingOptions options;
    options.landmark_age_s = age_s;
    options.max_landmarks = count;
    return options.Check().ok();
  };
  EXPECT_TRUE(accepts(0, 0));
  EXPECT_FALSE(accepts(-1, 100));
  EXPECT_FALSE(accepts(std::nan(""), 100));
  EXPECT_FALSE(accepts(1, -1));
}

TEST(TrackingOptions, RefuseWhatIsNoProbability) {
  EXPECT_TRUE(TrackingOptions().Check().ok());
  for (const double no_probability : {-0.1, 1.1, std::nan("")}) {
    TrackingOptions options;
    options.readmit_probability = no_probability;
    EXPECT_FALSE(options.Check().ok()) << no_probability;
  }
}

TEST(TrackingOptions, RefuseWhatMakesNoSense) {
  const auto message = [](auto value, auto mistake) {
    TrackingOptions options;
    options.*value = mistake;
    return options.Check().message();
  };
  EXPECT_NE(message(&TrackingOptions::max_neighbours, -1).find("max_neighbours"),
            std::string::npos);
  EXPECT_NE(message(&TrackingOptions::min_initial_depths, -1).find("min_initial_depths"),
            std::string::npos);
  for (const int rounds : {0, 11, 1000000000}) {
    EXPECT_NE(message(&TrackingOptions::local_search_rounds, rounds).find("from 1 to 10"),
              std::string::npos);
  }
  EXPECT_NE(message(&TrackingOptions::local_radius_factor_refined, 0), "");
  EXPECT_NE(message(&TrackingOptions::recently_lost_s, std::nan("")), "");
}

TEST(Tracker, NothingComesBackWhenItIsNotAllowed) {
  TrackingOptions options;
  options.readmit_probability = 1;
  Trip trip(options);
  for (int i = 0; i < 5; ++i) trip.Go(0.1);
  EXPECT_TRUE(trip.Go(0.1, InLeftThird).readmitted.empty());
}

}  // namespace
}  // namespace msf
