# Headers of others that most files include, read once instead of in every file: that saves a quarter of the work of a clean build. Files name
# what they include all the same; builds with CMAKE_DISABLE_PRECOMPILE_HEADERS (preset dev) would tell.
# What was precompiled fits only targets with the same flags: there is one set for libraries and one for programs that test.
file(WRITE ${PROJECT_BINARY_DIR}/precompiled.cc "")
add_library(msf_precompiled OBJECT ${PROJECT_BINARY_DIR}/precompiled.cc)
target_precompile_headers(msf_precompiled PRIVATE
  <algorithm> <array> <cmath> <filesystem> <fstream> <functional> <map> <memory> <optional> <random> <set> <span> <sstream> <string>
  <vector> <fmt/format.h> <Eigen/Core> <Eigen/Geometry> <opencv2/core.hpp> <opencv2/imgproc.hpp>)
target_link_libraries(msf_precompiled PRIVATE msf_compiler spdlog::spdlog Eigen3::Eigen opencv_core opencv_imgproc)

if(MSF_BUILD_TESTS)
  add_executable(msf_precompiled_for_tests ${PROJECT_BINARY_DIR}/precompiled.cc)
  get_target_property(headers msf_precompiled PRECOMPILE_HEADERS)
  target_precompile_headers(msf_precompiled_for_tests PRIVATE ${headers} <gtest/gtest.h> <gmock/gmock.h>)
  target_link_libraries(msf_precompiled_for_tests PRIVATE msf_compiler spdlog::spdlog Eigen3::Eigen opencv_core opencv_imgproc
                                                          GTest::gtest_main GTest::gmock)
endif()
