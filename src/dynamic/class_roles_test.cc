#include "dynamic/class_roles.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace msf {
namespace {

TEST(ClassRoles, FollowTheListsByCanonicalName) {
  const StatusOr<ClassRoles> roles =
      ClassRoles::Create({}, {"Person", "sofa", "aeroplane", "motorbike"});
  ASSERT_TRUE(roles.ok());
  EXPECT_EQ(roles->KindOf(0), ObjectKind::kKnown);
  EXPECT_EQ(roles->KindOf(1), ObjectKind::kPotential) << "a couch by its other name";
  EXPECT_EQ(roles->KindOf(2), std::nullopt) << "listed nowhere";
  EXPECT_EQ(roles->KindOf(3), ObjectKind::kKnown);
  EXPECT_EQ(roles->NameOf(1), "sofa") << "the detector's own name";
}

TEST(ClassRoles, WhatIsNoClassIsAMover) {
  const StatusOr<ClassRoles> roles = ClassRoles::Create({}, {"person"});
  ASSERT_TRUE(roles.ok());
  for (const int class_id : {-1, 1}) {
    EXPECT_EQ(roles->KindOf(class_id), std::nullopt);
    EXPECT_EQ(roles->NameOf(class_id), "mover");
  }
}

TEST(ClassRoles, AClassInBothListsIsKnown) {
  DynamicOptions options;
  options.known_classes = {"robot"};
  options.potential_classes = {"robot", "box"};
  const StatusOr<ClassRoles> roles = ClassRoles::Create(options, {"robot", "box"});
  ASSERT_TRUE(roles.ok());
  EXPECT_EQ(roles->KindOf(0), ObjectKind::kKnown);
  EXPECT_EQ(roles->KindOf(1), ObjectKind::kPotential);
}

TEST(ClassRoles, ADetectorWithoutAnyListedClassIsAnError) {
  const StatusOr<ClassRoles> roles = ClassRoles::Create({}, {"traffic light", "toaster"});
  ASSERT_FALSE(roles.ok());
  EXPECT_THAT(roles.message(), testing::HasSubstr("'traffic light'"));
  EXPECT_THAT(roles.message(), testing::HasSubstr("dynamic.known_classes"));
}

TEST(ClassRoles, AClassMayHaveAScoreOfItsOwn) {
  DynamicOptions options;
  options.tracks.start_score = 0.2;
  options.tracks.potential_score = 0.3;
  options.class_scores = {"Couch=0.7", "cat=0.6"};
  const StatusOr<ClassRoles> roles =
      ClassRoles::Create(options, {"person", "cat", "sofa", "chair"});
  ASSERT_TRUE(roles.ok());
  EXPECT_EQ(roles->StartScoreOf(0), 0.2);
  EXPECT_EQ(roles->StartScoreOf(1), 0.6);
  EXPECT_EQ(roles->StartScoreOf(2), 0.7) << "a couch by its other name";
  EXPECT_EQ(roles->StartScoreOf(3), 0.3);
}

TEST(ClassRoles, AScoreThatCannotBeReadIsAnError) {
  for (const char* text : {"cat", "cat=", "cat=high", "cat=1.5", "cat=-1", "cat=0.5x"}) {
    DynamicOptions options;
    options.class_scores = {text};
    const StatusOr<ClassRoles> roles = ClassRoles::Create(options, {"cat"});
    ASSERT_FALSE(roles.ok()) << text;
    EXPECT_THAT(roles.message(), testing::HasSubstr(text));
  }
}

TEST(ClassRoles, AScoreOfAClassThatTheDetectorDoesNotKnowIsAnError) {
  DynamicOptions options;
  options.class_scores = {"peron=0.5"};
  const StatusOr<ClassRoles> roles = ClassRoles::Create(options, {"person"});
  ASSERT_FALSE(roles.ok());
  EXPECT_THAT(roles.message(), testing::HasSubstr("'peron'"));
}

TEST(ClassRoles, NoDetectorIsFine) {
  EXPECT_TRUE(ClassRoles::Create({}, {}).ok());
  EXPECT_EQ(ClassRoles().KindOf(0), std::nullopt);
}

TEST(ObjectKind, HasNames) {
  EXPECT_STREQ(ToString(ObjectKind::kKnown), "known");
  EXPECT_STREQ(ToString(ObjectKind::kPotential), "potential");
  EXPECT_STREQ(ToString(ObjectKind::kUnknown), "unknown");
}

}  // namespace
}  // namespace msf
