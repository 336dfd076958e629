#include "dynamic/dynamic_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace msf {
namespace {

TEST(DynamicOptions, TheModesAreAccepted) {
  for (const char* mode : {"off", "boxes", "paper", "full"}) {
    DynamicOptions options;
    options.mode = mode;
    EXPECT_TRUE(options.Check().ok()) << mode;
  }
}

TEST(DynamicOptions, AnUnknownModeIsNamed) {
  DynamicOptions options;
  options.mode = "Full";
  EXPECT_THAT(options.Check().message(), testing::HasSubstr("'Full'"));
}

TEST(DynamicOptions, WhatMakesNoSenseIsAnError) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::function<void(DynamicOptions&)>> mistakes = {
      [](DynamicOptions& o) { o.paper_flow_px = 0; },
      [](DynamicOptions& o) { o.paper_flow_px = kNan; },
      [](DynamicOptions& o) { o.paper_window_px = 2; },
      [](DynamicOptions& o) { o.motion.min_residual_px = -1; },
      [](DynamicOptions& o) { o.motion.look_back_s = kNan; },
      [](DynamicOptions& o) { o.mask.depth_band_m = 0; },
      [](DynamicOptions& o) { o.mask.max_image_share = 0; },
      [](DynamicOptions& o) { o.mask.max_mover_share = 0; },
      [](DynamicOptions& o) { o.history_s = 0.1; },
      [](DynamicOptions& o) { o.max_feature_factor = 0.5; },
      [](DynamicOptions& o) { o.flow.shrink = 3; },
      [](DynamicOptions& o) { o.min_static_features = -1; },
      [](DynamicOptions& o) { o.background.oldest_s = kNan; },
      [](DynamicOptions& o) { o.planes.max_planes = -1; },
      [](DynamicOptions& o) { o.tracks.new_share = 1.5; },
  };
  for (size_t i = 0; i < mistakes.size(); ++i) {
    DynamicOptions options;
    mistakes[i](options);
    EXPECT_FALSE(options.Check().ok()) << "mistake " << i;
  }
}

TEST(DynamicOptions, ANegativeNumberIsNamed) {
  DynamicOptions options;
  options.tracks.settle_s = -3;
  EXPECT_THAT(options.Check().message(), testing::HasSubstr("dynamic.tracks.settle_s"));
}

}  // namespace
}  // namespace msf
