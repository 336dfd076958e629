#include "dynamic/object_track.h"

#include <gtest/gtest.h>

#include "dynamic/test_scene.h"

namespace msf {
namespace {

constexpr int kPerson = 0, kChair = 1, kLamp = 2;
const ImageBox kHere{100, 100, 200, 300}, kThere{400, 100, 500, 300};

ClassRoles Roles() { return *ClassRoles::Create({}, {"person", "chair", "lamp"}); }

class ObjectTracksTest : public ::testing::Test {
 protected:
  const ObjectTrack& Only() {
    EXPECT_EQ(tracks_.tracks().size(), 1u);
    return tracks_.tracks().at(0);
  }
  // What the motion test says about the first track, and its new state.
  MotionState Judge(int tested, int moving, double time_s) {
    tracks_.tracks().at(0).evidence = {.tested = tested, .moving = moving};
    tracks_.UpdateStates(time_s);
    return tracks_.tracks()[0].state;
  }
  ObjectTracks tracks_{ObjectTrackOptions(), Roles()};
};

using Detected = ObjectTracksTest;
using Motion = ObjectTracksTest;
using Lost = ObjectTracksTest;

TEST_F(Detected, APersonMovesUntilTheContraryIsKnown) {
  tracks_.TakeDetections({{kPerson, 0.9f, kHere}}, 1);
  EXPECT_EQ(Only().kind, ObjectKind::kKnown);
  EXPECT_EQ(Only().state, MotionState::kMoving);
  EXPECT_EQ(Only().confirmations, 1);
  EXPECT_EQ(Only().confirmed_s, 1);
  EXPECT_TRUE(Only().Removes());
}

TEST_F(Detected, AChairStandsUntilTheContraryIsKnown) {
  tracks_.TakeDetections({{kChair, 0.9f, kHere}}, 1);
  EXPECT_EQ(Only().kind, ObjectKind::kPotential);
  EXPECT_EQ(Only().state, MotionState::kUncertain);
  EXPECT_FALSE(Only().Removes());
}

TEST_F(Detected, WeakDetectionsAndOtherClassesStartNothing) {
  tracks_.TakeDetections({{kLamp, 0.9f, kHere}, {kChair, 0.39f, kHere}, {kPerson, 0.24f, kThere}},
                         1);
  EXPECT_TRUE(tracks_.tracks().empty());
}

TEST_F(Detected, ATrackIsContinuedWhereItOverlaps) {
  tracks_.TakeDetections({{kPerson, 0.9f, kHere}, {kPerson, 0.8f, kThere}}, 1);
  // Half of the box is common: intersection over union 1 / 3.
  const ImageBox moved{150, 100, 250, 300};
  tracks_.TakeDetections({{kPerson, 0.7f, moved}}, 2);
  ASSERT_EQ(tracks_.tracks().size(), 2u);
  const ObjectTrack &first = tracks_.tracks()[0], &second = tracks_.tracks()[1];
  EXPECT_NE(first.id, second.id);
  EXPECT_EQ(first.confirmations, 2);
  EXPECT_EQ(first.box.x0, 150);
  EXPECT_EQ(first.confirmed_s, 2);
  EXPECT_FLOAT_EQ(first.score, 0.7f);
  EXPECT_EQ(second.confirmations, 1);
  EXPECT_EQ(second.confirmed_s, 1);
}

TEST_F(Detected, AWeakDetectionContinuesOnlyWhatLooksTheSame) {
  tracks_.TakeDetections({{kPerson, 0.9f, kHere}}, 1);
  tracks_.TakeDetections({{kPerson, 0.12f, {110, 100, 210, 300}}}, 1.1);  // 90 / 110 of it
  EXPECT_EQ(Only().confirmations, 2);
  tracks_.TakeDetections({{kPerson, 0.12f, {160, 100, 260, 300}}}, 1.2);  // 50 / 150 of it
  EXPECT_EQ(Only().confirmations, 2);
  tracks_.TakeDetections({{kPerson, 0.09f, Only().box}}, 1.3);
  EXPECT_EQ(Only().confirmations, 2);
}

TEST_F(Detected, WeakDetectionsAloneDoNotKeepATrackForLong) {
  tracks_.TakeDetections({{kPerson, 0.9f, kHere}}, 1);
  tracks_.TakeDetections({{kPerson, 0.12f, kHere}}, 1.4);
  EXPECT_EQ(Only().confirmed_s, 1.4);
  tracks_.TakeDetections({{kPerson, 0.12f, kHere}}, 1.6);
  EXPECT_EQ(Only().confirmed_s, 1.4) << "something else may have taken the person's place";
  tracks_.TakeDetections({{kPerson, 0.3f, kHere}}, 1.7);
  EXPECT_EQ(Only().confirmed_s, 1.7) << "strong enough to start one";
}

TEST_F(Detected, WeakDetectionsKeepATrackThatIsSeenToMove) {
  tracks_.TakeDetections({{kPerson, 0.9f, kHere}}, 1);
  Judge(20, 15, 1.5);
  tracks_.TakeDetections({{kPerson, 0.12f, kHere}}, 1.9);
  EXPECT_EQ(Only().confirmed_s, 1.9);
}

TEST_F(Detected, ADetectionOfAnotherClassMustBeStrongAndLookTheSame) {
  ObjectTracks tracks(ObjectTrackOptions(), *ClassRoles::Create({}, {"person", "cat"}));
  constexpr int kCat = 1;
  tracks.TakeDetections({{kPerson, 0.9f, kHere}}, 1);
  tracks.TakeDetections({{kCat, 0.2f, kHere}}, 1.1);
  EXPECT_EQ(tracks.tracks()[0].class_id, kPerson) << "weak";
  tracks.TakeDetections({{kCat, 0.3f, kHere}}, 1.2);
  EXPECT_EQ(tracks.tracks()[0].class_id, kCat) << "the same thing under another name";
  tracks.TakeDetections({{kPerson, 0.9f, {150, 100, 250, 300}}}, 1.3);  // a third in common
  EXPECT_EQ(tracks.tracks().size(), 2u) << "elsewhere";
}

TEST_F(Detected, AWeakDetectionIsOfUseNearATrackOfItsKindOnly) {
  const FrameId then(7);
  EXPECT_FALSE(tracks_.MayTake({kPerson, 0.12f, kHere}, then));
  EXPECT_TRUE(tracks_.MayTake({kPerson, 0.3f, kHere}, then)) << "it can start a track";
  EXPECT_FALSE(tracks_.MayTake({kLamp, 0.9f, kHere}, then)) << "it never moves";
  tracks_.TakeDetections({{kPerson, 0.9f, kHere}}, 1);
  EXPECT_TRUE(tracks_.MayTake({kPerson, 0.12f, {180, 100, 280, 300}}, then));
  EXPECT_FALSE(tracks_.MayTake({kPerson, 0.09f, kHere}, then));
  EXPECT_FALSE(tracks_.MayTake({kChair, 0.12f, kHere}, then));
  EXPECT_FALSE(tracks_.MayTake({kPerson, 0.12f, kThere}, then));
  tracks_.RememberBoxes(then, 10);
  tracks_.tracks()[0].box = kThere;
  EXPECT_TRUE(tracks_.MayTake({kPerson, 0.12f, kHere}, then)) << "where the track was then";
}

TEST_F(Detected, APersonCutByTheBorderIsTheSamePerson) {
  tracks_.TakeDetections({{kPerson, 0.9f, kHere}}, 1);
  tracks_.TakeDetections({{kPerson, 0.9f, {100, 260, 200, 300}}}, 2);  // a fifth of it
  EXPECT_EQ(Only().confirmations, 2);
}

TEST_F(Detected, TheSameThingUnderTwoNamesIsOneObject) {
  tracks_.TakeDetections({{kPerson, 0.9f, kHere}, {kChair, 0.85f, kHere}}, 1);
  EXPECT_EQ(Only().kind, ObjectKind::kKnown);
}

TEST_F(Detected, SomebodyOnAChairIsNoEchoOfIt) {
  tracks_.TakeDetections({{kChair, 0.85f, kHere}, {kPerson, 0.8f, kHere}}, 1);
  ASSERT_EQ(tracks_.tracks().size(), 2u);
  EXPECT_EQ(tracks_.tracks()[1].kind, ObjectKind::kKnown);
  tracks_.TakeDetections({{kChair, 0.85f, kThere}, {kPerson, 0.3f, kThere}}, 2);
  EXPECT_EQ(tracks_.tracks().size(), 3u) << "so weak that it rather is a second look at the chair";
}

TEST_F(Detected, AMuchWeakerBoxInsideAnotherIsAnEcho) {
  tracks_.TakeDetections({{kPerson, 0.9f, kHere}, {kPerson, 0.4f, {110, 110, 150, 150}}}, 1);
  EXPECT_EQ(tracks_.tracks().size(), 1u);
  tracks_.TakeDetections({{kPerson, 0.9f, kHere}, {kPerson, 0.8f, {110, 110, 150, 150}}}, 2);
  EXPECT_EQ(tracks_.tracks().size(), 2u) << "almost as strong: another person";
}

TEST_F(Detected, AnotherClassDoesNotContinueATrack) {
  tracks_.TakeDetections({{kPerson, 0.9f, kHere}}, 1);
  tracks_.TakeDetections({{kChair, 0.9f, kHere}}, 2);
  EXPECT_EQ(tracks_.tracks().size(), 2u);
}

TEST_F(Detected, WhereAnotherTrackWasConfirmedABridgedOneWasMistaken) {
  tracks_.TakeDetections({{kPerson, 0.9f, kHere}, {kChair, 0.9f, kThere}}, 1);
  tracks_.tracks()[1].box = kHere;  // has drifted onto the person
  tracks_.TakeDetections({{kPerson, 0.9f, kHere}}, 1.1);
  tracks_.DropLost(1.1, true);
  EXPECT_EQ(Only().kind, ObjectKind::kKnown);
}

ObjectMask MaskOf(int area, float depth_m) {
  ObjectMask mask;
  mask.area = area;
  mask.depth_m = depth_m;
  return mask;
}

TEST_F(Detected, SomebodyWhoIsHiddenByAnotherIsBridged) {
  tracks_.TakeDetections({{kPerson, 0.9f, kHere}, {kPerson, 0.9f, kThere}}, 1);
  tracks_.tracks()[0].mask = MaskOf(500, 1.5f);
  tracks_.tracks()[1].mask = MaskOf(500, 3);
  tracks_.tracks()[1].box = kHere;  // has walked behind the first
  tracks_.TakeDetections({{kPerson, 0.9f, kHere}}, 1.1);
  tracks_.DropLost(1.1, true);
  EXPECT_EQ(tracks_.tracks().size(), 2u);
}

// All of `box`, at a depth.
ObjectMask MaskOver(const ImageBox& box, float depth_m) {
  ObjectMask mask = WholeBox(CoarseDepth(DepthFrame(depth_m)), box);
  mask.depth_m = depth_m;
  return mask;
}

TEST_F(Detected, AMoverMustBeSeenThreeTimes) {
  for (int i = 1; i <= 3; ++i) {
    EXPECT_TRUE(i == 1 || !Only().Removes());
    tracks_.TakeMover(MaskOver(kHere, 2), 0.1 * i);
    Judge(10, 10, 0.1 * i);
  }
  EXPECT_EQ(Only().kind, ObjectKind::kUnknown);
  EXPECT_EQ(Only().class_id, -1);
  EXPECT_EQ(Only().confirmations, 3);
  EXPECT_TRUE(Only().Removes());
  Judge(10, 3, 0.4);
  EXPECT_FALSE(Only().Removes()) << "this image does not show that it moves";
}

TEST_F(Detected, SeveralClustersOfOneImageAreOneConfirmation) {
  for (int i = 0; i < 3; ++i) tracks_.TakeMover(MaskOver(kHere, 2), 1);
  EXPECT_EQ(Only().confirmations, 1);
  EXPECT_FALSE(Only().Removes());
}

TEST_F(Detected, AMoverElsewhereIsAnother) {
  tracks_.TakeMover(MaskOver(kHere, 2), 1);
  tracks_.TakeMover(MaskOver(kThere, 2), 1);
  EXPECT_EQ(tracks_.tracks().size(), 2u);
  tracks_.TakeMover(MaskOver(kHere, 2.4f), 1);
  EXPECT_EQ(tracks_.tracks().size(), 3u) << "one behind the other";
}

TEST_F(Detected, AMoverKeepsItsBodyWhenOnlyAPartIsSeenToMove) {
  tracks_.TakeMover(MaskOver(kHere, 2), 1);
  const ObjectMask whole = Only().mask;
  const ImageBox hand{kHere.x0 + 8, kHere.y0 + 8, kHere.x0 + 32, kHere.y0 + 32};
  tracks_.TakeMover(MaskOver(hand, 2.2f), 1.1);
  EXPECT_EQ(Only().mask.area, whole.area);
  EXPECT_EQ(Only().mask.depth_m, 2);
  EXPECT_EQ(Only().box.x1, whole.box.x1);
  const ImageBox beside{hand.x0 - 20, hand.y0, hand.x1, hand.y1};
  tracks_.TakeMover(MaskOver(beside, 2), 1.2);
  EXPECT_GT(Only().mask.area, whole.area);
  EXPECT_EQ(Only().box.x0, kHere.x0 - 12);
  EXPECT_EQ(Only().confirmations, 3);
}

TEST_F(Detected, MoversThatCoverEachOtherAreOne) {
  tracks_.TakeMover(MaskOver(kHere, 2), 1);
  tracks_.TakeMover(MaskOver(kThere, 2), 1);
  ObjectTrack& grown = tracks_.tracks()[1];  // both have grown over the same thing
  grown.mask = MaskOver({kHere.x0, kHere.y0, kHere.x1 + 20, kHere.y1}, 2);
  grown.confirmations = 3;
  const int area = grown.mask.area;
  const int older = tracks_.tracks()[0].id;
  tracks_.MergeMovers();
  EXPECT_EQ(Only().id, older);
  EXPECT_EQ(Only().mask.area, area);
  EXPECT_EQ(Only().confirmations, 3);
  tracks_.TakeMover(MaskOver(kHere, 3), 1);
  tracks_.MergeMovers();
  EXPECT_EQ(tracks_.tracks().size(), 2u) << "one behind the other";
}

TEST_F(Detected, AMoverMayTurnOutToBeAPerson) {
  tracks_.TakeMover(MaskOver(kHere, 2), 1);
  const int id = Only().id;
  tracks_.TakeDetections({{kPerson, 0.2f, kHere}}, 2);
  EXPECT_EQ(Only().kind, ObjectKind::kUnknown) << "too weak to start a track";
  tracks_.TakeDetections({{kPerson, 0.3f, kHere}}, 2);
  EXPECT_EQ(Only().kind, ObjectKind::kKnown);
  EXPECT_EQ(Only().id, id);
}

TEST_F(Detected, AMoverAtRestThatTurnsOutToBeAPersonIsRemovedAgain) {
  tracks_.TakeMover(MaskOver(kHere, 2), 1);
  EXPECT_EQ(Judge(20, 0, 1.5), MotionState::kStatic);
  tracks_.TakeDetections({{kPerson, 0.9f, kHere}}, 1.6);
  EXPECT_EQ(Only().state, MotionState::kMoving);
  EXPECT_EQ(Judge(20, 0, 1.7), MotionState::kMoving) << "it begins to rest now";
}

TEST_F(Motion, APersonComesToRestAndMovesAgain) {
  tracks_.TakeDetections({{kPerson, 0.9f, kHere}}, 0);
  EXPECT_EQ(Judge(100, 8, 0.9), MotionState::kMoving);
  EXPECT_EQ(Judge(100, 8, 1.1), MotionState::kUncertain) << "a third of settle_s";
  EXPECT_TRUE(Only().Removes());
  EXPECT_EQ(Judge(100, 8, 2.9), MotionState::kUncertain);
  EXPECT_EQ(Judge(100, 8, 3.1), MotionState::kStatic);
  EXPECT_FALSE(Only().Removes());
  EXPECT_EQ(Judge(100, 24, 3.2), MotionState::kStatic) << "not enough to move";
  EXPECT_EQ(Judge(100, 25, 3.3), MotionState::kMoving);
  EXPECT_EQ(Judge(100, 0, 6.2), MotionState::kUncertain) << "rests since 3.3 s";
}

TEST_F(Motion, WhileAPersonMovesALittleOrNothingIsKnownItDoesNotBeginToRest) {
  tracks_.TakeDetections({{kPerson, 0.9f, kHere}}, 0);
  EXPECT_EQ(Judge(100, 15, 10), MotionState::kMoving);
  EXPECT_EQ(Judge(4, 0, 20), MotionState::kMoving) << "too few points";
  EXPECT_EQ(Judge(100, 0, 20.9), MotionState::kMoving);
  EXPECT_EQ(Judge(100, 0, 21.1), MotionState::kUncertain);
}

TEST_F(Motion, APersonAtRestOfWhomNothingIsKnownGoesOnResting) {
  tracks_.TakeDetections({{kPerson, 0.9f, kHere}}, 0);
  EXPECT_EQ(Judge(100, 0, 4), MotionState::kStatic);
  EXPECT_EQ(Judge(4, 4, 5), MotionState::kStatic);
}

TEST_F(Motion, AChairIsRemovedWhileMostOfItMoves) {
  tracks_.TakeDetections({{kChair, 0.9f, kHere}}, 0);
  EXPECT_EQ(Judge(100, 49, 0.1), MotionState::kUncertain);
  EXPECT_EQ(Judge(100, 50, 0.2), MotionState::kMoving);
  EXPECT_TRUE(Only().Removes());
  EXPECT_EQ(Only().confirmed_s, 0.2) << "its motion was seen";
  EXPECT_EQ(Judge(100, 0, 0.25), MotionState::kMoving);
  EXPECT_EQ(Judge(100, 0, 0.3), MotionState::kUncertain) << "a third of mover_settle_s";
  EXPECT_FALSE(Only().Removes());
  EXPECT_EQ(Judge(100, 0, 0.5), MotionState::kStatic);
}

TEST_F(Motion, WhatStandsInAPlaceThatWasFreeHasMoved) {
  tracks_.TakeDetections({{kChair, 0.9f, kHere}}, 0);
  tracks_.tracks()[0].evidence = {.blocks = 100, .new_blocks = 35};
  tracks_.UpdateStates(1);
  EXPECT_EQ(Only().state, MotionState::kUncertain);
  tracks_.tracks()[0].evidence.new_blocks = 36;
  tracks_.UpdateStates(2);
  EXPECT_EQ(Only().state, MotionState::kMoving);
  EXPECT_EQ(Only().confirmed_s, 2);
}

TEST(MotionEvidence, Shares) {
  EXPECT_EQ(MotionEvidence().MovingShare(), 0);
  EXPECT_EQ(MotionEvidence().NewShare(), 0);
  EXPECT_FALSE(MotionEvidence().SpeaksForMotion());
  const MotionEvidence moving{.tested = 20, .moving = 7}, appeared{.blocks = 5, .new_blocks = 1};
  EXPECT_DOUBLE_EQ(moving.MovingShare(), 0.35);
  EXPECT_TRUE(moving.SpeaksForMotion());
  EXPECT_DOUBLE_EQ(appeared.NewShare(), 0.2);
  EXPECT_TRUE(appeared.SpeaksForMotion());
}

TEST_F(Lost, AnObjectIsFollowedForAWhile) {
  tracks_.TakeDetections({{kPerson, 0.9f, kHere}}, 1);
  tracks_.DropLost(1, true);
  tracks_.DropLost(1.65, true);
  EXPECT_EQ(tracks_.tracks().size(), 1u);
  tracks_.DropLost(1.75, true);
  EXPECT_TRUE(tracks_.tracks().empty());
}

TEST_F(Lost, ADoubtfulObjectIsFollowedByTheNumberOfItsDetections) {
  tracks_.TakeDetections({{kPerson, 0.3f, kHere}}, 1);
  tracks_.DropLost(1.09, true);
  EXPECT_EQ(tracks_.tracks().size(), 1u) << "0.1 s for one detection";
  tracks_.TakeDetections({{kPerson, 0.4f, kHere}}, 1.09);
  tracks_.DropLost(1.28, true);
  EXPECT_EQ(tracks_.tracks().size(), 1u);
  tracks_.DropLost(1.3, true);
  EXPECT_TRUE(tracks_.tracks().empty());
}

TEST_F(Lost, ADoubtfulObjectOfALateDetectionIsFollowedUntilTheNextOneMayCome) {
  tracks_.TakeDetections({{kPerson, 0.3f, kHere}}, 1, 0.33);
  tracks_.DropLost(1.42, true);
  EXPECT_EQ(tracks_.tracks().size(), 1u);
  tracks_.DropLost(1.44, true);
  EXPECT_TRUE(tracks_.tracks().empty());
}

TEST_F(Lost, WithoutBridgingItIsForgottenAtOnce) {
  tracks_.TakeDetections({{kPerson, 0.9f, kHere}}, 1);
  tracks_.DropLost(1, false);
  EXPECT_EQ(tracks_.tracks().size(), 1u);
  tracks_.DropLost(1.01, false);
  EXPECT_TRUE(tracks_.tracks().empty());
}

TEST_F(Lost, AnOldAcquaintanceThatLooksTheSameIsFollowedForLonger) {
  for (int i = 0; i < 10; ++i) tracks_.TakeDetections({{kPerson, 0.9f, kHere}}, 1);
  tracks_.tracks()[0].mask = MaskOf(100, 2);
  tracks_.DropLost(1, true);
  tracks_.tracks()[0].mask = MaskOf(60, 2.2f);
  tracks_.DropLost(3.4, true);
  EXPECT_EQ(tracks_.tracks().size(), 1u);
  tracks_.tracks()[0].mask = MaskOf(60, 2.3f);
  tracks_.DropLost(3.4, true);
  EXPECT_TRUE(tracks_.tracks().empty()) << "something else is there now";
}

TEST_F(Lost, AMoverWithoutAMaskHasVanished) {
  tracks_.TakeMover(MaskOver(kHere, 2), 1);
  tracks_.tracks()[0].mask = MaskOf(12, 2);
  tracks_.DropLost(1, true);
  EXPECT_EQ(tracks_.tracks().size(), 1u);
  tracks_.tracks()[0].mask = MaskOf(11, 2);
  tracks_.DropLost(1, true);
  EXPECT_TRUE(tracks_.tracks().empty());
}

TEST_F(Lost, TheLastBoxesAreRemembered) {
  tracks_.TakeDetections({{kPerson, 0.9f, kHere}}, 1);
  for (int i = 0; i < 3; ++i) {
    tracks_.tracks()[0].box.x0 = static_cast<float>(i);
    tracks_.RememberBoxes(FrameId(i), 2);
  }
  EXPECT_EQ(Only().BoxAt(FrameId(0)), std::nullopt);
  ASSERT_TRUE(Only().BoxAt(FrameId(1)).has_value());
  EXPECT_EQ(Only().BoxAt(FrameId(1))->x0, 1);
  EXPECT_EQ(Only().BoxAt(FrameId(2))->x0, 2);
}

TEST(MotionState, HasNames) {
  EXPECT_STREQ(ToString(MotionState::kMoving), "moving");
  EXPECT_STREQ(ToString(MotionState::kUncertain), "uncertain");
  EXPECT_STREQ(ToString(MotionState::kStatic), "static");
}

}  // namespace
}  // namespace msf
