#include "dynamic/object_mask.h"

#include <gtest/gtest.h>

#include "dynamic/test_scene.h"

namespace msf {
namespace {

// A thing of 40 x 60 cells, and the box that a detector might draw around it.
const cv::Rect kThing_px(240, 120, 160, 240);
const ImageBox kBox{220, 100, 420, 380};

ObjectMaskOptions WithoutGrowing() {
  ObjectMaskOptions options;
  options.grow_px = options.grow_without_depth_px = 0;
  return options;
}

CoarseDepth ThingBeforeWall() { return CoarseDepth(DepthFrame(kWall_m, {{kThing_px, kThing_m}})); }

void ExpectBox(const ImageBox& box, const ImageBox& expected) {
  EXPECT_EQ(box.x0, expected.x0);
  EXPECT_EQ(box.y0, expected.y0);
  EXPECT_EQ(box.x1, expected.x1);
  EXPECT_EQ(box.y1, expected.y1);
}

TEST(CoarseDepth, TakesOnePixelPerCell) {
  RgbdFrame frame = DepthFrame(0);
  frame.depth.at<uint16_t>(2, 6) = 7500;  // of cell (1, 0)
  frame.depth.at<uint16_t>(3, 3) = 9999;  // of none
  const CoarseDepth depth(frame);
  EXPECT_EQ(depth.rows(), 120);
  EXPECT_EQ(depth.cols(), 160);
  EXPECT_FLOAT_EQ(depth.metres()(0, 1), 1.5f);
  EXPECT_EQ(depth.metres()(0, 0), 0);
  EXPECT_FLOAT_EQ(depth.At({4, 0}), 1.5f);
  EXPECT_EQ(depth.CellOf(-5, 1000), cv::Point(0, 119));
  EXPECT_TRUE(CoarseDepth().empty());
}

TEST(WholeBox, CoversTheCellsOfTheBox) {
  const ObjectMask mask = WholeBox(ThingBeforeWall(), {8, 8, 16, 12});
  EXPECT_EQ(mask.area, 2);
  ExpectBox(mask.box, {8, 8, 16, 12});
  EXPECT_TRUE(mask.Covers({8, 8}));
  EXPECT_TRUE(mask.Covers({15.9f, 11.9f}));
  EXPECT_FALSE(mask.Covers({16, 8}));
  EXPECT_FALSE(mask.Covers({-9, 8}));
  EXPECT_FALSE(mask.Covers({8, 1000}));
}

TEST(WholeBox, IsCutToTheImage) {
  const ObjectMask mask = WholeBox(ThingBeforeWall(), {630, 470, 700, 500});
  EXPECT_EQ(mask.area, 9);
  ExpectBox(mask.box, {628, 468, 640, 480});
}

TEST(ObjectMask, EmptyCoversNothing) { EXPECT_FALSE(ObjectMask().Covers({0, 0})); }

TEST(MaskInBox, IsTheThingAndNotTheWallBesideIt) {
  const ObjectMask mask =
      MaskInBox(ThingBeforeWall(), {}, kBox, false, std::nullopt, WithoutGrowing());
  EXPECT_EQ(mask.area, 40 * 60);
  ExpectBox(mask.box, {240, 120, 400, 360});
  EXPECT_NEAR(mask.depth_m, kThing_m, 0.15);
}

TEST(MaskInBox, GrowsByOneCell) {
  ObjectMaskOptions options;
  options.grow_px = 4;
  const ObjectMask mask = MaskInBox(ThingBeforeWall(), {}, kBox, false, std::nullopt, options);
  EXPECT_EQ(mask.area, 40 * 60 + 2 * (40 + 60));
  ExpectBox(mask.box, {236, 116, 404, 364});
}

TEST(MaskInBox, GrowsFartherWhereThereIsNoDepth) {
  ObjectMaskOptions options = WithoutGrowing();
  options.grow_without_depth_px = 12;
  const CoarseDepth depth(
      DepthFrame(kWall_m, {{kThing_px, kThing_m}, {{kThing_px.br().x, kThing_px.y, 40, 240}, 0}}));
  const ObjectMask mask = MaskInBox(depth, {}, kBox, false, std::nullopt, options);
  EXPECT_TRUE(mask.Covers({411, 240}));
  EXPECT_FALSE(mask.Covers({412, 240}));
  EXPECT_FALSE(mask.Covers({239, 240})) << "the wall has depth";
}

TEST(MaskInBox, ReachesOnlyALittleBeyondTheBox) {
  // A tenth of 80 px on either side of the box.
  const ObjectMask mask =
      MaskInBox(ThingBeforeWall(), {}, {280, 200, 360, 280}, false, std::nullopt, WithoutGrowing());
  ExpectBox(mask.box, {272, 192, 368, 288});
}

TEST(MaskInBox, ASmallStepInDepthIsPartOfTheThingALargeOneIsNot) {
  // 0.03 * 2.04 m + 0.02 m = 0.081 m.
  const cv::Rect right_px(320, 120, 80, 240);
  const auto area = [&](float step_m) {
    const CoarseDepth depth(
        DepthFrame(kWall_m, {{kThing_px, kThing_m}, {right_px, kThing_m + step_m}}));
    // So that only the left half has seeds.
    return MaskInBox(depth, {}, {180, 120, 380, 360}, false, std::nullopt, WithoutGrowing()).area;
  };
  EXPECT_EQ(area(0.07f), 40 * 60);
  EXPECT_EQ(area(0.3f), 20 * 60);
}

TEST(MaskInBox, TheNearerOfTwoLargeClustersUnlessAnotherWasThere) {
  const CoarseDepth depth(
      DepthFrame(5, {{{200, 100, 120, 280}, 2.04f}, {{320, 100, 120, 280}, 3.04f}}));
  const ImageBox box{200, 100, 440, 380};
  const ObjectMask near = MaskInBox(depth, {}, box, false, std::nullopt, WithoutGrowing());
  ExpectBox(near.box, {200, 100, 320, 380});
  const ObjectMask followed = MaskInBox(depth, {}, box, false, 3.1f, WithoutGrowing());
  ExpectBox(followed.box, {320, 100, 440, 380});
  const ObjectMask nothing_there = MaskInBox(depth, {}, box, false, 7.0f, WithoutGrowing());
  ExpectBox(nothing_there.box, near.box);
}

TEST(MaskInBox, SmallPiecesAreLeftOut) {
  const CoarseDepth depth(
      DepthFrame(kWall_m, {{{240, 120, 80, 240}, kThing_m}, {{360, 200, 16, 16}, kThing_m}}));
  const ObjectMask mask = MaskInBox(depth, {}, kBox, false, std::nullopt, WithoutGrowing());
  EXPECT_EQ(mask.area, 20 * 60);
  EXPECT_FALSE(mask.Covers({368, 208}));
}

TEST(MaskInBox, WithoutDepthTheBoxIsTheMask) {
  const CoarseDepth depth(DepthFrame(kWall_m, {{kThing_px, 0}}));
  const ObjectMask mask =
      MaskInBox(depth, {}, {240, 120, 400, 360}, false, std::nullopt, WithoutGrowing());
  EXPECT_EQ(mask.area, 40 * 60);
  EXPECT_EQ(mask.depth_m, 0);
}

// Blocks right of `x_px` are confirmed.
BlockVerdicts ConfirmedFrom(int x_px) {
  BlockVerdicts verdicts(60, 80);
  for (int r = 0; r < verdicts.rows(); ++r) {
    for (int c = x_px / 8; c < verdicts.cols(); ++c) verdicts.Set(r, c, BlockVerdict::kConfirmed);
  }
  return verdicts;
}

TEST(MaskInBox, WhoIsTooNearToBeMeasuredIsTheObject) {
  // Someone without depth fills most of the box; beside him the wall shows.
  const CoarseDepth depth(DepthFrame(kWall_m, {{{220, 100, 130, 280}, 0}}));
  const ObjectMask mask = MaskInBox(depth, {}, kBox, false, std::nullopt, WithoutGrowing());
  EXPECT_TRUE(mask.Covers({280, 240}));
  ObjectMaskOptions options = WithoutGrowing();
  options.near_depth_share = 0;
  EXPECT_FALSE(MaskInBox(depth, {}, kBox, false, std::nullopt, options).Covers({280, 240}));
}

TEST(MaskInBox, GrowsTwiceAsFarOverMissingDepthWhereTheObjectHasNone) {
  ObjectMaskOptions options = WithoutGrowing();
  options.grow_without_depth_px = 8;
  // Depth is missing in the right part of the box and on to x = 500.
  const auto right_end_px = [&](int missing_from_px) {
    const cv::Rect missing(missing_from_px, 120, 500 - missing_from_px, 240);
    const CoarseDepth depth(DepthFrame(kWall_m, {{kThing_px, kThing_m}, {missing, 0}}));
    return MaskInBox(depth, {}, {240, 120, 400, 360}, false, std::nullopt, options).box.x1;
  };
  EXPECT_EQ(right_end_px(400), 400 + 8) << "the thing has depth";
  EXPECT_EQ(right_end_px(300), 400 + 16) << "most of it has none: all of the box is the object";
}

TEST(Union, CoversWhatEitherDoes) {
  const CoarseDepth depth = ThingBeforeWall();
  const ObjectMask left = WholeBox(depth, {8, 8, 40, 40}), right = WholeBox(depth, {32, 8, 48, 40});
  const ObjectMask both = Union(left, right);
  EXPECT_EQ(both.area, 10 * 8);
  ExpectBox(both.box, {8, 8, 48, 40});
  EXPECT_EQ(Union(left, {}).area, left.area);
  EXPECT_EQ(Union({}, left).area, left.area);
}

TEST(MaskInBox, WhatWasThereBeforeIsNotPartOfTheThing) {
  const ObjectMask mask =
      MaskInBox(ThingBeforeWall(), ConfirmedFrom(352), kBox, false, std::nullopt, WithoutGrowing());
  ExpectBox(mask.box, {240, 120, 352, 360});
}

TEST(MaskInBox, UnlessMostOfTheThingWas) {
  const ObjectMask mask =
      MaskInBox(ThingBeforeWall(), ConfirmedFrom(272), kBox, true, std::nullopt, WithoutGrowing());
  EXPECT_EQ(mask.area, 40 * 60);
}

TEST(MaskAroundPoints, FloodsFromPointsOfTheRightDepthWithinTheBox) {
  const ImageBox box{280, 200, 360, 280};
  const ObjectMask mask = MaskAroundPoints(ThingBeforeWall(), {}, {{320, 240}, {320, 60}}, kThing_m,
                                           box, WithoutGrowing());
  ExpectBox(mask.box, box);
  EXPECT_EQ(mask.area, 20 * 20);
  EXPECT_EQ(mask.depth_m, kThing_m);
}

TEST(MaskAroundPoints, IsEmptyWhereNoPointFits) {
  const ImageBox box{0, 0, 640, 480};
  EXPECT_TRUE(MaskAroundPoints(ThingBeforeWall(), {}, {{320, 60}}, kThing_m, box, {}).empty());
  EXPECT_TRUE(MaskAroundPoints(ThingBeforeWall(), ConfirmedFrom(0), {{320, 240}}, kThing_m, box, {})
                  .empty());
}

}  // namespace
}  // namespace msf
