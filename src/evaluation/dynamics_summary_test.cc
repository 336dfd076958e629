#include "evaluation/dynamics_summary.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "evaluation/run_folder.h"

namespace msf {
namespace {

using testing::HasSubstr;

// Four frames: one that was not tracked, then detections of age none, 0 and 9.
RunResults FourFrames() {
  RunResults results;
  results.dynamic_mode = "full";
  results.detector = DetectorRecord{"tiny", 3, 1, "frame 1: out of order", 12};
  results.frames.resize(4);
  for (int i = 1; i < 4; ++i) {
    DynamicsRecord record;
    record.points[static_cast<size_t>(PointReason::kStatic)] = 60;
    record.points[static_cast<size_t>(PointReason::kObject)] = 20 * i;
    record.mask_share = 0.1 * i;
    record.detection_age = i == 1 ? -1 : i == 2 ? 0 : 9;
    record.num_objects = i;
    results.frames[i].dynamics = record;
  }
  return results;
}

TEST(DynamicsSummary, AddsUpFrames) {
  const std::optional<DynamicsSummary> summary = SummarizeDynamics(FourFrames());
  ASSERT_TRUE(summary);
  EXPECT_EQ(summary->num_frames, 3u);
  EXPECT_DOUBLE_EQ(summary->PointShare(PointReason::kObject), 120.0 / 300);
  EXPECT_DOUBLE_EQ(summary->PointShare(PointReason::kFlow), 0);
  EXPECT_NEAR(summary->mean_mask_share, 0.2, 1e-12);
  EXPECT_NEAR(summary->max_mask_share, 0.3, 1e-12);
  EXPECT_DOUBLE_EQ(summary->mean_objects, 2);
  EXPECT_DOUBLE_EQ(summary->age_max, 9);
  EXPECT_NEAR(summary->stale_share, 2.0 / 3, 1e-12);
  EXPECT_THAT(summary->Warnings(),
              testing::ElementsAre(HasSubstr("1 of 3 frames; the first: frame 1: out of order"),
                                   HasSubstr("67 % of the frames")));
}

TEST(DynamicsSummary, WithoutDetectorNothingIsStale) {
  RunResults results = FourFrames();
  results.detector.reset();
  const std::optional<DynamicsSummary> summary = SummarizeDynamics(results);
  EXPECT_THAT(summary->Warnings(), testing::IsEmpty());
  EXPECT_TRUE(DynamicsToJson(*summary).at("detector").is_null());
  EXPECT_THAT(FormatDynamics(*summary), HasSubstr("detector     none"));
}

TEST(DynamicsSummary, ModeOffHasNone) {
  RunResults results = FourFrames();
  for (FrameRecord& frame : results.frames) frame.dynamics.reset();
  EXPECT_FALSE(SummarizeDynamics(results));
  EXPECT_THAT(FormatFramesCsv(results.frames), testing::Not(HasSubstr("mask_share")));
}

TEST(DynamicsSummary, JsonAndTextSayTheSame) {
  const DynamicsSummary summary = *SummarizeDynamics(FourFrames());
  const nlohmann::json json = DynamicsToJson(summary);
  EXPECT_EQ(json.at("points").at("object"), 120);
  EXPECT_EQ(json.at("detector").at("frames_failed"), 1);
  EXPECT_THAT(FormatDynamics(summary),
              AllOf(HasSubstr("60.0 % static, 40.0 % object points"), HasSubstr("tiny: 3 frames")));
}

TEST(DynamicsSummary, EveryRowOfTheCsvHasAllColumns) {
  const std::string csv = FormatFramesCsv(FourFrames().frames);
  EXPECT_THAT(csv,
              HasSubstr("keyframe_id,points_static,points_box,points_object,points_flow,"
                        "points_depth,points_settled,"
                        "points_readmitted,points_known,mask_share,detection_age,objects,note\n"));
  EXPECT_THAT(csv, HasSubstr(",60,0,20,0,0,0,0,0,0.1000,,1,\n"));
  const std::string none = DynamicsCsvCells(nullptr), header = DynamicsCsvHeader();
  EXPECT_EQ(std::count(none.begin(), none.end(), ','),
            std::count(header.begin(), header.end(), ','));
}

}  // namespace
}  // namespace msf
