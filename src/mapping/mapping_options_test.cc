#include "mapping/mapping_options.h"

#include <gtest/gtest.h>

#include <cmath>

namespace msf {
namespace {

TEST(MappingOptions, CloseIsADistance) {
  MappingOptions options;
  EXPECT_TRUE(options.Check().ok());
  for (const double baselines : {0.0, -40.0, std::nan("")}) {
    options.close_depth_baselines = baselines;
    EXPECT_NE(options.Check().message().find("close_depth_baselines"), std::string::npos);
  }
}

}  // namespace
}  // namespace msf
