#include "sensor/rgbd_frame.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "util/check.h"

namespace msf {
namespace {

using testing::HasSubstr;

RgbdFrame GoodFrame() {
  RgbdFrame frame;
  frame.camera = std::make_shared<const Camera>(*Camera::Preset("simulated"));
  frame.color = cv::Mat(480, 640, CV_8UC3);
  frame.depth = cv::Mat(480, 640, CV_16UC1);
  return frame;
}

TEST(RgbdFrame, ColourAndGreyAreGood) {
  RgbdFrame frame = GoodFrame();
  EXPECT_TRUE(CheckFrame(frame).ok());
  frame.color = cv::Mat(480, 640, CV_8UC1);
  EXPECT_TRUE(CheckFrame(frame).ok());
}

TEST(RgbdFrame, ImagesThatDoNotFitTheCameraAreNamedWithTheirSizes) {
  RgbdFrame frame = GoodFrame();
  frame.depth = cv::Mat(240, 320, CV_16UC1);
  EXPECT_THAT(CheckFrame(frame).message(), HasSubstr("colour is 640x480 and depth 320x240"));
  frame = GoodFrame();
  frame.color = cv::Mat();
  EXPECT_THAT(CheckFrame(frame).message(), HasSubstr("colour is 0x0"));
}

TEST(RgbdFrame, PixelsOfTheWrongTypeAreRefused) {
  RgbdFrame frame = GoodFrame();
  for (const int type : {CV_16UC3, CV_8UC4, CV_32FC1}) {
    frame.color = cv::Mat(480, 640, type);
    EXPECT_THAT(CheckFrame(frame).message(), HasSubstr("colour image")) << type;
  }
  frame = GoodFrame();
  for (const int type : {CV_8UC1, CV_32FC1, CV_16UC3}) {
    frame.depth = cv::Mat(480, 640, type);
    EXPECT_THAT(CheckFrame(frame).message(), HasSubstr("depth image")) << type;
  }
}

TEST(RgbdFrame, AFrameWithoutCameraIsABug) {
  RgbdFrame frame = GoodFrame();
  frame.camera = nullptr;
  EXPECT_THROW((void)CheckFrame(frame), ContractViolation);
}

}  // namespace
}  // namespace msf
