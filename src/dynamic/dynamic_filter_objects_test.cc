#include <gtest/gtest.h>

#include "dynamic/test_filter.h"

namespace msf {
namespace {

TEST(DynamicFilterObjects, AChairIsRemovedOnlyOnceItMoves) {
  const auto filter = MakeFilter(Mode("full"));
  const auto look = [&](int number, int shift_px) {
    const cv::Rect px = Shifted(kThing_px, shift_px);
    const Detections found = Found(number, {{kChair, 0.9f, BoxOf(px)}});
    return Classify(*filter, TexturedFrame(number, 0.1 * number, 0, px), &found)
        .ShareOf(PointReason::kObject, BoxOf(px));
  };
  EXPECT_EQ(look(0, 0), 0);
  EXPECT_EQ(look(1, 0), 0);
  EXPECT_EQ(look(2, 8), 1);
}

TEST(DynamicFilterObjects, APersonIsFollowedWhereTheDetectorMissesIt) {
  const auto filter = MakeFilter(Mode("full"));
  const Detections found = Found(0, {{kPerson, 0.9f, BoxOf(kThing_px)}});
  Classify(*filter, TexturedFrame(0, 0, 0, kThing_px), &found);
  for (int i = 1; i <= 5; ++i) {
    const cv::Rect px = Shifted(kThing_px, 8 * i);
    const Detections none = Found(i, {});
    const Seen seen = Classify(*filter, TexturedFrame(i, 0.1 * i, 0, px), &none);
    EXPECT_EQ(seen.ShareOf(PointReason::kObject, BoxOf(px)), 1) << i;
    const DynamicObject* person = FindPerson(seen.result);
    ASSERT_NE(person, nullptr);
    EXPECT_TRUE(person->removed);
    EXPECT_NEAR(person->box.x0, static_cast<float>(px.x), 8);
  }
}

TEST(DynamicFilterObjects, LateDetectionsAreCarriedToThePresent) {
  const auto filter = MakeFilter(Mode("full"));
  const Detections found = Found(0, {{kPerson, 0.9f, BoxOf(kThing_px)}});
  for (int i = 0; i < 3; ++i)
    Classify(*filter, TexturedFrame(i, 0.1 * i, 0, Shifted(kThing_px, 6 * i)));
  const cv::Rect px = Shifted(kThing_px, 18);
  const Seen seen = Classify(*filter, TexturedFrame(3, 0.3, 0, px), &found);
  EXPECT_EQ(seen.result.detection_age, 3);
  EXPECT_EQ(seen.ShareOf(PointReason::kObject, BoxOf(px)), 1);
  const DynamicObject* person = FindPerson(seen.result);
  ASSERT_NE(person, nullptr);
  EXPECT_NEAR(person->box.x0, static_cast<float>(px.x), 8);
}

TEST(DynamicFilterObjects, HowLateDetectionsMayBeIsAMatterOfTime) {
  constexpr int kLate = 20;
  const auto finds_person = [](double fps) {
    const auto filter = MakeFilter(Mode("full"));
    const Detections found = Found(0, {{kPerson, 0.9f, BoxOf(kThing_px)}});
    for (int i = 0; i < kLate; ++i)
      Classify(*filter, TexturedFrame(i, i / fps, 0, Shifted(kThing_px, i)));
    const Seen seen =
        Classify(*filter, TexturedFrame(kLate, kLate / fps, 0, Shifted(kThing_px, kLate)), &found);
    return FindPerson(seen.result) != nullptr;
  };
  EXPECT_TRUE(finds_person(60)) << "a third of a second";
  EXPECT_FALSE(finds_person(20)) << "a second";
}

TEST(DynamicFilterObjects, DetectionsOfTheImageBeforeAreCarriedByWhatWasFollowedAnyway) {
  const auto filter = MakeFilter(Mode("full"));
  Classify(*filter, TexturedFrame(0, 0, 0, kThing_px));
  for (int i = 1; i <= 4; ++i) {
    const cv::Rect before = Shifted(kThing_px, 12 * (i - 1)), px = Shifted(kThing_px, 12 * i);
    const Detections found = Found(i - 1, {{kPerson, 0.9f, BoxOf(before)}});
    const Seen seen = Classify(*filter, TexturedFrame(i, 0.1 * i, 0, px), &found);
    EXPECT_EQ(seen.ShareOf(PointReason::kObject, BoxOf(px)), 1) << i;
    const DynamicObject* person = FindPerson(seen.result);
    ASSERT_NE(person, nullptr);
    EXPECT_NEAR(person->box.x0, static_cast<float>(px.x), 8);
  }
}

TEST(DynamicFilterObjects, AMoverOfUnknownClassIsFound) {
  const auto filter = MakeFilter(Mode("full"));
  Classify(*filter, TexturedFrame(0, 0, 0, kThing_px));
  for (int i = 1; i <= 6; ++i) {
    const cv::Rect px = Shifted(kThing_px, 10 * i);
    const Seen seen = Classify(*filter, TexturedFrame(i, 0.1 * i, 0, px));
    EXPECT_LT(seen.ShareOf(PointReason::kStatic, BoxOf(px, -16)), 0.02) << i;
    EXPECT_GT(seen.ShareOf(PointReason::kStatic, BoxOf(px, 40), false), 0.98) << i;
    ASSERT_FALSE(seen.result.objects.empty());
    EXPECT_EQ(seen.result.objects[0].name, "mover");
    EXPECT_EQ(seen.result.objects[0].state, MotionState::kMoving);
    EXPECT_GT(seen.result.objects[0].moving_share, 0.9);
  }
}

// The wall as a camera sees it that has turned by `turn_px` in the middle of the image; before it a
// thing of which a part carries a texture of its own and the rest looks like the wall.
RgbdFrame TurnedFrame(int number, float turn_px, const cv::Rect& thing_px,
                      const cv::Rect& part_px) {
  const Camera& camera = *TestCamera();
  RgbdFrame frame = TexturedFrame(number, number / 30.0, 0);
  const auto f = static_cast<float>(camera.fx), cx = static_cast<float>(camera.cx),
             cy = static_cast<float>(camera.cy), a = turn_px / f;
  const cv::Matx33f K(f, 0, cx, 0, f, cy, 0, 0, 1);
  const cv::Matx33f R(std::cos(a), 0, std::sin(a), 0, 1, 0, -std::sin(a), 0, std::cos(a));
  cv::warpPerspective(frame.color.clone(), frame.color, K * R * K.inv(), frame.color.size(),
                      cv::INTER_LINEAR, cv::BORDER_REFLECT);
  TexturedFrame(number, 0, 0, part_px).color(part_px).copyTo(frame.color(part_px));
  frame.depth = MakeDepth(kWall_m, {{thing_px, kThing_m}});
  return frame;
}

TEST(DynamicFilterObjects, WhileTheCameraTurnsADetectorKnowsBetterWhatMovesInPart) {
  constexpr int kTurn_px = 10, kFrames = 5;
  // A third of the thing moves downwards.
  const auto finds_mover = [](bool detector_works, int turn_px) {
    const auto filter = MakeFilter(Mode("full"));
    bool found = false;
    for (int i = 0; i < kFrames; ++i) {
      const Detections nothing = Found(i, {});
      const RgbdFrame frame =
          TurnedFrame(i, static_cast<float>(turn_px * i), Shifted(kThing_px, turn_px * i),
                      {240 + turn_px * i, 120 + 8 * i, 64, 160});
      const Seen seen = Classify(*filter, frame, detector_works ? &nothing : nullptr);
      found = found || !seen.result.objects.empty();
    }
    return found;
  };
  EXPECT_FALSE(finds_mover(true, kTurn_px));
  EXPECT_TRUE(finds_mover(false, kTurn_px)) << "flow alone must do without a detector";
  EXPECT_TRUE(finds_mover(true, 0)) << "the camera rests";
}

TEST(DynamicFilterObjects, AMoverDoesNotFlowOverWhatItTouches) {
  const auto filter = MakeFilter(Mode("full"));
  const cv::Rect box_px(120, 200, 96, 96), table_px(40, 296, 560, 140);
  for (int i = 0; i <= 12; ++i) {
    const cv::Rect px = Shifted(box_px, 10 * i);
    RgbdFrame frame = TexturedFrame(i, 0.1 * i, 0, px);
    frame.depth(table_px) = cv::Scalar(kThing_m * TestCamera()->depth_factor);
    const Seen seen = Classify(*filter, frame);
    if (i == 0) continue;
    EXPECT_GT(seen.ShareOf(PointReason::kObject, BoxOf(px, -16)) +
                  seen.ShareOf(PointReason::kFlow, BoxOf(px, -16)),
              0.98)
        << i;
    EXPECT_GT(seen.ShareOf(PointReason::kStatic, BoxOf(table_px)), 0.75) << i;
  }
}

TEST(DynamicFilterObjects, WhoWasSeenOftenIsRememberedWhereNothingIsDetected) {
  for (const bool remembers : {true, false}) {
    DynamicOptions options = Mode("full");
    options.tracks.settle_s = 100;
    if (!remembers) options.background.min_memory_views = 0;
    const auto filter = MakeFilter(options);
    Seen seen;
    for (int i = 0; i < 60; ++i) {
      Detections found = Found(i, {{kPerson, 0.9f, BoxOf(kThing_px)}});
      if (i >= 30) found.objects.clear();
      seen = Classify(*filter, TexturedFrame(i, 0.1 * i, 0, kThing_px), &found);
    }
    EXPECT_EQ(FindPerson(seen.result), nullptr) << "he is followed no more";
    const double removed = seen.ShareOf(PointReason::kObject, BoxOf(kThing_px, -8));
    EXPECT_EQ(removed, remembers ? 1 : 0);
    EXPECT_GT(seen.ShareOf(PointReason::kStatic, BoxOf(kThing_px, 24), false), 0.98);
  }
}

// A small piece of the wall's surface that moves: too few points to make a mover of them.
void AddSpeck(const cv::Rect& px, RgbdFrame& frame) {
  static const cv::Mat kSpeck = MakeTexture(13);
  kSpeck(cv::Rect({0, 0}, px.size())).copyTo(frame.color(px));
}

TEST(DynamicFilterObjects, FewPointsThatMoveAreRemovedOnlyBesideAnObject) {
  const cv::Rect beside(kThing_px.br().x + 16, 204, 24, 24), far_away(76, 204, 24, 24);
  const auto filter = MakeFilter(Mode("full"));
  for (int i = 0; i < 3; ++i) {
    RgbdFrame frame = TexturedFrame(i, 0.1 * i, 0, kThing_px);
    for (const cv::Rect& px : {beside, far_away}) AddSpeck(Shifted(px, 8 * i), frame);
    const Detections found = Found(i, {{kPerson, 0.9f, BoxOf(kThing_px)}});
    const Seen seen = Classify(*filter, frame, &found);
    if (i == 0) continue;
    const ImageBox near_box = BoxOf(Shifted(beside, 8 * i)),
                   far_box = BoxOf(Shifted(far_away, 8 * i));
    EXPECT_EQ(seen.ShareOf(PointReason::kFlow, near_box), 1) << i;
    EXPECT_EQ(seen.ShareOf(PointReason::kReadmitted, far_box), 1) << i;
  }
}

TEST(DynamicFilterObjects, WhatHasComeInIsRemovedThoughItStandsStillNow) {
  const auto filter = MakeFilter(Mode("full"));
  for (int i = 0; i < 10; ++i) Classify(*filter, TexturedFrame(i, 0.1 * i, 0));
  for (int i = 10; i < 15; ++i) {
    const Seen seen = Classify(*filter, TexturedFrame(i, 0.1 * i, 0, kThing_px));
    const double removed = seen.ShareOf(PointReason::kObject, BoxOf(kThing_px));
    EXPECT_TRUE(i < 12 || removed == 1) << i << ": " << removed;
  }
}

}  // namespace
}  // namespace msf
