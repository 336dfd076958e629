#include "evaluation/evaluation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "evaluation/evaluation_report.h"
#include "evaluation/statistics.h"

namespace msf {
namespace {

using testing::HasSubstr;

// A screw motion: position and heading at time t.
Rigid3d ScrewPose(double t) {
  return {ExpRotation({0, 0, 0.3 * t}),
          Eigen::Vector3d(std::cos(0.5 * t), std::sin(0.5 * t), 0.1 * t)};
}

Trajectory Screw(double start_s, double step_s, int n) {
  Trajectory trajectory;
  for (int i = 0; i < n; ++i)
    trajectory.push_back({start_s + i * step_s, ScrewPose(start_s + i * step_s)});
  return trajectory;
}

TEST(Statistics, AreThoseOfThePopulation) {
  const std::vector<double> values = {4, 1, 2, 9};
  const Statistics s = ComputeStatistics(values);
  EXPECT_DOUBLE_EQ(s.mean, 4);
  EXPECT_DOUBLE_EQ(s.median, 3);
  EXPECT_DOUBLE_EQ(s.rmse, std::sqrt(102.0 / 4));
  EXPECT_DOUBLE_EQ(s.std, std::sqrt(38.0 / 4));
  EXPECT_DOUBLE_EQ(s.min, 1);
  EXPECT_DOUBLE_EQ(s.max, 9);
  EXPECT_THROW(ComputeStatistics({}), ContractViolation);
}

TEST(Statistics, PercentilesInterpolate) {
  const std::vector<double> values = {30, 10, 20};
  EXPECT_DOUBLE_EQ(Percentile(values, 0), 10);
  EXPECT_DOUBLE_EQ(Percentile(values, 0.75), 25);
  EXPECT_DOUBLE_EQ(Percentile(values, 1), 30);
}

TEST(AssociateTrajectories, TakesTheNearestWithinTheGap) {
  const Trajectory truth = Screw(0, 0.01, 200);
  const auto pairs = AssociateTrajectories(
      truth, {{0.124, Rigid3d()}, {0.5, Rigid3d()}, {2.009, Rigid3d()}, {2.011, Rigid3d()}});
  ASSERT_EQ(pairs.size(), 3u);
  EXPECT_DOUBLE_EQ(pairs[0].true_T_wc.translation().z(), 0.012);
  EXPECT_DOUBLE_EQ(pairs[1].true_T_wc.translation().z(), 0.05);
  EXPECT_DOUBLE_EQ(pairs[2].time_s, 2.009);
}

TEST(AssociateTrajectories, TheShorterOneLeads) {
  const Trajectory truth = Screw(0, 0.1, 4);
  EXPECT_EQ(AssociateTrajectories(truth, Screw(0, 0.01, 40)).size(), 4u);
  EXPECT_EQ(AssociateTrajectories(truth, {{0.1, Rigid3d()}, {0.101, Rigid3d()}}).size(), 2u);
  EXPECT_TRUE(AssociateTrajectories(truth, {}).empty());
}

TEST(EvaluateTrajectory, AMovedWorldCostsNothing) {
  const Trajectory truth = Screw(0, 0.01, 500);
  const Rigid3d other_world(ExpRotation({1, 2, -0.5}), Eigen::Vector3d(5, 6, 7));
  Trajectory estimate = Screw(0, 0.04, 120);
  for (StampedPose& pose : estimate) pose.T_wc = other_world * pose.T_wc;
  const Evaluation e = *EvaluateTrajectory("e", truth, estimate, {.num_input_frames = 160});
  EXPECT_NEAR(ComputeStatistics(e.absolute.translation_m.value).max, 0, 1e-9);
  EXPECT_NEAR(ComputeStatistics(e.per_second.rotation_rad.value).max, 0, 1e-7);
  EXPECT_EQ(e.per_frame.translation_m.value.size(), 119u);
  EXPECT_EQ(e.per_second.translation_m.value.size(), 95u);
  EXPECT_DOUBLE_EQ(*e.Coverage(), 0.75);
}

TEST(EvaluateTrajectory, FreeScaleUndoesAScale) {
  const Trajectory truth = Screw(0, 0.04, 120);
  Trajectory estimate = truth;
  for (StampedPose& pose : estimate)
    pose.T_wc = Rigid3d(pose.T_wc.rotation(), Eigen::Vector3d(0.5 * pose.T_wc.translation()));
  EXPECT_GT(
      ComputeStatistics(EvaluateTrajectory("e", truth, estimate)->absolute.translation_m.value)
          .rmse,
      0.1);
  const Evaluation scaled =
      *EvaluateTrajectory("e", truth, estimate, {.scale = ScaleEstimation::kFree});
  EXPECT_NEAR(scaled.absolute.T_true_estimated.scale, 2, 1e-12);
  EXPECT_NEAR(ComputeStatistics(scaled.absolute.translation_m.value).max, 0, 1e-9);
  EXPECT_NEAR(ComputeStatistics(scaled.per_frame.translation_m.value).max, 0, 1e-9);
}

TEST(EvaluateTrajectory, RelativeErrorSeesDriftPerStretch) {
  const Trajectory truth = Screw(0, 0.1, 50);
  Trajectory estimate = truth;
  Rigid3d drift;
  for (StampedPose& pose : estimate) {
    pose.T_wc = pose.T_wc * drift;
    drift = drift * Rigid3d(ExpRotation({0, 0, 0.01}), Eigen::Vector3d::Zero());
  }
  const Evaluation e = *EvaluateTrajectory("e", truth, estimate);
  EXPECT_NEAR(ComputeStatistics(e.per_frame.rotation_rad.value).mean, 0.01, 1e-9);
  EXPECT_NEAR(ComputeStatistics(e.per_second.rotation_rad.value).mean, 0.1, 1e-9);
}

TEST(EvaluateTrajectory, StretchesDoNotSpanGaps) {
  Trajectory truth = Screw(0, 0.1, 100);
  Trajectory estimate = truth;
  estimate.erase(estimate.begin() + 20, estimate.begin() + 60);
  // 20 poses before the gap give 10 stretches of a second, 40 after it give 30.
  EXPECT_EQ(EvaluateTrajectory("e", truth, estimate)->per_second.translation_m.value.size(), 40u);
}

TEST(EvaluateTrajectory, WhatCannotBeEvaluatedGetsASentence) {
  const Trajectory truth = Screw(0, 0.1, 50);
  EXPECT_THAT(EvaluateTrajectory("late", truth, Screw(1000, 0.1, 50)).message(),
              AllOf(HasSubstr("late"), HasSubstr("0 of 50")));
  Trajectory still = truth;
  for (StampedPose& pose : still) pose.T_wc = Rigid3d();
  EXPECT_THAT(EvaluateTrajectory("still", truth, still).message(), HasSubstr("coincide"));
}

TEST(EvaluationReport, TableAndJsonHoldTheSameFigures) {
  const Trajectory truth = Screw(0, 0.1, 5);  // too short for a stretch of a second
  Trajectory estimate = truth;
  estimate[2].T_wc = Rigid3d(estimate[2].T_wc.rotation(),
                             estimate[2].T_wc.translation() + Eigen::Vector3d(0, 0, 0.25));
  const Evaluation e = *EvaluateTrajectory("run", truth, estimate, {.num_input_frames = 10});
  const nlohmann::json json = EvaluationToJson(e);
  EXPECT_EQ(json.at("coverage"), 0.5);
  EXPECT_TRUE(json.at("rpe_1_s").at("translation_m").is_null());
  const std::string table = FormatTable({e, e});
  EXPECT_THAT(table, HasSubstr("50.0 %"));
  EXPECT_THAT(table, HasSubstr(std::to_string(json.at("ate_m").at("rmse").get<double>())));
}

}  // namespace
}  // namespace msf
