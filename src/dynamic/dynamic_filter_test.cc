#include <gtest/gtest.h>

#include <limits>

#include "dynamic/test_filter.h"

namespace msf {
namespace {

TEST(DynamicFilter, RefusesWhatItCannotDo) {
  const auto create = [](const DynamicOptions& options, const std::vector<std::string>& classes) {
    return DynamicFilter::Create(options, *TestCamera(), TestLevels(), classes, 1);
  };
  EXPECT_FALSE(create(Mode("magic"), {"person"}).ok());
  EXPECT_FALSE(create(Mode("full"), {"toaster"}).ok());
  EXPECT_TRUE(create(Mode("full"), {}).ok());
}

TEST(DynamicFilter, OffEverythingIsStatic) {
  const auto filter = MakeFilter(Mode("off"));
  const RgbdFrame frame = TexturedFrame(0, 0, 0, kThing_px);
  const Detections found = Found(0, {{kPerson, 0.9f, BoxOf(kThing_px)}});
  const Seen seen = Classify(*filter, frame, &found);
  EXPECT_EQ(seen.labels().Counts()[0], seen.features.size());
  EXPECT_TRUE(seen.result.mask.empty());
  EXPECT_TRUE(seen.result.objects.empty());
}

TEST(DynamicFilterBoxes, WhatIsInABoxIsDropped) {
  const auto filter = MakeFilter(Mode("boxes"));
  const ImageBox box{200, 100, 400, 340};
  const Detections found = Found(3, {{kPerson, 0.9f, box}});
  const Seen seen = Classify(*filter, TexturedFrame(5, 0, 0), &found);
  EXPECT_EQ(seen.ShareOf(PointReason::kBox, box), 1);
  EXPECT_EQ(seen.ShareOf(PointReason::kStatic, box, false), 1);
  EXPECT_EQ(seen.result.detection_age, 2);
  ASSERT_EQ(seen.result.objects.size(), 1u);
  EXPECT_EQ(seen.result.objects[0].name, "person");
  EXPECT_TRUE(seen.result.objects[0].removed);
  EXPECT_EQ(cv::countNonZero(seen.result.mask), 50 * 60);
  EXPECT_DOUBLE_EQ(seen.result.mask_share, 50 * 60 / (160.0 * 120));
  const DynamicOptions options;
  for (int i = 0; i < seen.features.size(); ++i) {
    EXPECT_EQ(seen.labels().static_probability[i] < options.min_static_probability,
              seen.labels().reason[i] == PointReason::kBox);
  }
}

TEST(DynamicFilterBoxes, WeakOtherAndSenselessBoxesDoNotCount) {
  const auto filter = MakeFilter(Mode("boxes"));
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const ImageBox box{200, 100, 400, 340};
  const Detections found = Found(0, {{kPerson, 0.24f, box},
                                     {kChair, 0.39f, box},
                                     {kLamp, 0.9f, box},
                                     {7, 0.9f, box},
                                     {kPerson, 0.9f, {kNan, 100, 400, 340}},
                                     {kPerson, kNan, box},
                                     {kPerson, 0.9f, {400, 100, 200, 340}},
                                     {kPerson, 0.9f, {700, 100, 900, 340}},
                                     {kPerson, 0.9f, {200, 100, 203, 340}}});
  const Seen seen = Classify(*filter, TexturedFrame(0, 0, 0), &found);
  EXPECT_EQ(seen.labels().Counts()[0], seen.features.size());
  EXPECT_TRUE(seen.result.objects.empty());
}

TEST(DynamicFilterBoxes, WithoutDetectionsEverythingIsStatic) {
  const auto filter = MakeFilter(Mode("boxes"));
  const Seen seen = Classify(*filter, TexturedFrame(0, 0, 0));
  EXPECT_EQ(seen.labels().Counts()[0], seen.features.size());
  EXPECT_EQ(seen.result.detection_age, -1);
  EXPECT_EQ(filter->FeatureFactor(), 1);
}

TEST(DynamicFilterBoxes, TheNextImageNeedsMorePoints) {
  const auto filter = MakeFilter(Mode("boxes"));
  Detections found = Found(0, {{kPerson, 0.9f, {0, 0, 128, 480}}});
  Classify(*filter, TexturedFrame(0, 0, 0), &found);
  EXPECT_DOUBLE_EQ(filter->FeatureFactor(), 1.25) << "a fifth is covered";
  found = Found(1, {{kPerson, 0.9f, {0, 0, 640, 480}}});
  Classify(*filter, TexturedFrame(1, 0.1, 0), &found);
  EXPECT_EQ(filter->FeatureFactor(), DynamicOptions().max_feature_factor);
}

TEST(DynamicFilterPaper, RawFlowBeyondTheLimitIsMotion) {
  const auto filter = MakeFilter(Mode("paper"));
  const ImageBox all{0, 0, 640, 480};
  EXPECT_EQ(Classify(*filter, TexturedFrame(0, 0, 0)).ShareOf(PointReason::kStatic, all), 1);
  EXPECT_GT(Classify(*filter, TexturedFrame(1, 0.1, 1)).ShareOf(PointReason::kStatic, all), 0.98)
      << "1 px";
  EXPECT_GT(Classify(*filter, TexturedFrame(2, 0.2, 3)).ShareOf(PointReason::kFlow, all), 0.98)
      << "2 px, by the camera's motion alone";
}

TEST(DynamicFilterPaper, ABoxCountsBeforeTheFlow) {
  const auto filter = MakeFilter(Mode("paper"));
  Classify(*filter, TexturedFrame(0, 0, 0));
  const ImageBox box{200, 100, 400, 340};
  const Detections found = Found(1, {{kPerson, 0.9f, box}});
  const Seen seen = Classify(*filter, TexturedFrame(1, 0.1, 3), &found);
  EXPECT_EQ(seen.ShareOf(PointReason::kBox, box), 1);
  EXPECT_GT(seen.ShareOf(PointReason::kFlow, box, false), 0.98);
}

// --- Mode full

TEST(DynamicFilterFull, TheCamerasMotionIsTakenOut) {
  const auto filter = MakeFilter(Mode("full"));
  Classify(*filter, TexturedFrame(0, 0, 0));
  // 7 px: the camera went to the left by 7 / 525 of the wall's distance.
  for (int i = 1; i < 4; ++i) {
    const Seen seen = Classify(*filter, TexturedFrame(i, 0.1 * i, 7 * static_cast<float>(i)));
    EXPECT_TRUE(seen.result.camera_motion_reliable);
    EXPECT_GT(seen.ShareOf(PointReason::kStatic, {0, 0, 640, 480}), 0.98) << i;
  }
}

TEST(DynamicFilterFull, OfABoxOnlyTheThingIsRemoved) {
  const RgbdFrame frame = TexturedFrame(0, 0, 0, kThing_px);
  const Detections found = Found(0, {{kPerson, 0.9f, BoxOf(kThing_px, 40)}});
  const auto filter = MakeFilter(Mode("full"));
  const Seen seen = Classify(*filter, frame, &found);
  EXPECT_EQ(seen.ShareOf(PointReason::kObject, BoxOf(kThing_px)), 1);
  EXPECT_EQ(seen.ShareOf(PointReason::kStatic, BoxOf(kThing_px, 16), false), 1);
  ASSERT_EQ(seen.result.objects.size(), 1u);
  EXPECT_EQ(seen.result.objects[0].state, MotionState::kMoving);
  EXPECT_FALSE(seen.result.objects[0].bridged);

  DynamicOptions options;
  options.depth_split = false;
  const auto without_split = MakeFilter(options);
  EXPECT_EQ(
      Classify(*without_split, frame, &found).ShareOf(PointReason::kObject, BoxOf(kThing_px, 40)),
      1);
}

TEST(DynamicFilterFull, OfAPersonOnlyWhatMovesItselfIsSureToMove) {
  const auto filter = MakeFilter(Mode("full"));
  const auto look = [&](int number, int shift_px) {
    const cv::Rect px = Shifted(kThing_px, shift_px);
    const Detections found = Found(number, {{kPerson, 0.9f, BoxOf(px)}});
    const Seen seen = Classify(*filter, TexturedFrame(number, 0.1 * number, 0, px), &found);
    std::vector<float> probabilities;
    for (int i = 0; i < seen.features.size(); ++i) {
      const Eigen::Vector2f& at_px = seen.features.image_px[i];
      if (BoxOf(px, -16).Contains(at_px.x(), at_px.y()))
        probabilities.push_back(seen.labels().static_probability[i]);
    }
    std::nth_element(probabilities.begin(), probabilities.begin() + probabilities.size() / 2,
                     probabilities.end());
    return probabilities[probabilities.size() / 2];
  };
  const double limit = DynamicOptions().min_static_probability;
  const float unknown = look(0, 0), still = look(1, 0), moving = look(2, 8);
  EXPECT_LT(still, limit);
  EXPECT_GT(still, 2 * moving) << "the map may know better";
  EXPECT_EQ(unknown, moving) << "what could not be tested is no better than what moves";
}

TEST(DynamicFilterFull, WithoutWeightsAPointIsStaticOrNot) {
  DynamicOptions options;
  options.weights = false;
  const auto filter = MakeFilter(options);
  const Detections found = Found(0, {{kPerson, 0.9f, BoxOf(kThing_px)}});
  const Seen seen = Classify(*filter, TexturedFrame(0, 0, 0, kThing_px), &found);
  for (int i = 0; i < seen.features.size(); ++i) {
    EXPECT_EQ(seen.labels().static_probability[i],
              seen.labels().reason[i] == PointReason::kStatic ? 1 : 0);
  }
}

TEST(DynamicFilterFull, SuspiciousPointsAreReadmittedWhereTooFewAreLeft) {
  DynamicOptions options;
  const RgbdFrame frame = TexturedFrame(0, 0, 0, kThing_px);
  const Detections found = Found(0, {{kPerson, 0.9f, BoxOf(kThing_px)}});
  const Seen usual = Classify(*MakeFilter(options), frame, &found);
  const int num_static = usual.labels().Counts()[static_cast<size_t>(PointReason::kStatic)];
  ASSERT_LT(num_static, usual.features.size() - 10);
  options.min_static_features = num_static + 10;
  const Seen seen = Classify(*MakeFilter(options), frame, &found);
  EXPECT_EQ(seen.labels().Counts()[static_cast<size_t>(PointReason::kReadmitted)], 10);
  const FrameFeatures kept = SplitByProbability(seen.features, seen.labels(),
                                                options.min_static_probability, *TestCamera())
                                 .used;
  EXPECT_EQ(kept.size(), num_static + 10);
}

TEST(DynamicFilterFull, ACorrectedMapAndALostCameraAreSurvived) {
  const auto filter = MakeFilter(Mode("full"));
  const Rigid3d elsewhere(Eigen::Quaterniond::Identity(), {1, 2, 3});
  for (int i = 0; i < 12; ++i) {
    const RgbdFrame frame = TexturedFrame(i, 0.1 * i, 0);
    const DynamicResult result = filter->Classify(frame, GridFeatures(frame), {}, nullptr);
    EXPECT_EQ(result.labels.Counts()[0], result.labels.size()) << i;
    // Frame 4 is lost; from frame 8 on the world has other coordinates.
    filter->TakePose(i == 4 ? std::nullopt : std::optional(i < 8 ? Rigid3d() : elsewhere), i != 8,
                     {});
  }
}

// A thing that covers most of the image goes to the right before a wall that stands still.
Seen SeenAfterFourSteps(bool with_landmarks) {
  std::vector<Landmark> landmarks;
  for (int y = 20; with_landmarks && y < 100; y += 16) {
    for (int x = 20; x < 620; x += 40) {
      const Eigen::Vector2d px(x, y);
      landmarks.push_back({px.cast<float>(), TestCamera()->Unproject(px, kWall_m)});
    }
  }
  const auto filter = MakeFilter(Mode("full"));
  Seen seen;
  for (int i = 0; i < 4; ++i) {
    const RgbdFrame frame = TexturedFrame(i, 0.03 * i, 0, {40 + 6 * i, 120, 560, 360});
    seen.features = GridFeatures(frame);
    seen.result = filter->Classify(frame, seen.features, {}, nullptr);
    filter->TakePose(Rigid3d(), true, landmarks);
  }
  return seen;
}

TEST(DynamicFilterFull, LandmarksTellTheCamerasMotionWhereMostOfTheImageMoves) {
  const ImageBox wall{0, 0, 640, 110};
  EXPECT_FALSE(SeenAfterFourSteps(false).result.T_now_last);
  const Seen seen = SeenAfterFourSteps(true);
  ASSERT_TRUE(seen.result.T_now_last);
  EXPECT_LT(seen.result.T_now_last->Log().norm(), 1e-3);
  EXPECT_GT(seen.ShareOf(PointReason::kStatic, wall), 0.9);
}

TEST(DynamicFilterFull, AnImageWithoutPointsIsSurvived) {
  const auto filter = MakeFilter(Mode("full"));
  for (int i = 0; i < 3; ++i) {
    const DynamicResult result = filter->Classify(TexturedFrame(i, 0.1 * i, 0), {}, {}, nullptr);
    EXPECT_EQ(result.labels.size(), 0);
    EXPECT_FALSE(result.camera_motion_reliable);
    filter->TakePose(std::nullopt, true, {});
  }
}

TEST(SplitByProbability, KeepsWhatIsStaticEnoughWithItsWeight) {
  FrameFeatures features;
  for (int i = 0; i < 4; ++i)
    AddFeature({100.0f + 50.0f * static_cast<float>(i), 200}, 2, features);
  features.depth_m[3] = 0;
  features.u_right_px[3] = -1;
  features.level[3] = 5;
  PointLabels labels(4);
  labels.Set(0, PointReason::kObject, 0.05f);
  labels.Set(2, PointReason::kFlow, 0.29f);
  labels.Set(3, PointReason::kReadmitted, 0.3f);
  const auto [kept, removed, removed_from] =
      SplitByProbability(features, labels, 0.3, *TestCamera());
  ASSERT_EQ(kept.size(), 2);
  EXPECT_EQ(removed_from, (std::vector<int>{0, 2}));
  EXPECT_EQ(kept.static_weight, (std::vector<float>{1, 0.3f}));
  EXPECT_EQ(removed.static_weight, (std::vector<float>{0.05f, 0.29f}));
  EXPECT_EQ(removed.image_px[1], features.image_px[2]);
  for (const auto& [now, before] : {std::pair{0, 1}, std::pair{1, 3}}) {
    EXPECT_EQ(kept.image_px[now], features.image_px[before]);
    EXPECT_EQ(kept.uv_px[now], features.uv_px[before]);
    EXPECT_EQ(kept.depth_m[now], features.depth_m[before]);
    EXPECT_EQ(kept.u_right_px[now], features.u_right_px[before]);
    EXPECT_EQ(kept.angle_rad[now], features.angle_rad[before]);
    EXPECT_EQ(kept.level[now], features.level[before]);
    EXPECT_EQ(kept.descriptors[now], features.descriptors[before]);
  }
  std::vector<int> found;
  kept.FindInArea({250, 200}, 5, 0, 7, found);
  EXPECT_EQ(found, std::vector<int>{1}) << "the grid is that of the points kept";
}

}  // namespace
}  // namespace msf
