#include "detection/mirror_average.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace msf {
namespace {

TEST(AverageDetections, JoinsWhatOverlapsAndHalvesWhatWasSeenOnce) {
  const ImageBox box{10, 10, 30, 50}, nearby{12, 10, 32, 50}, elsewhere{60, 10, 90, 50};
  const std::vector<Detection> averaged = AverageDetections(
      {{0, 0.6F, box}, {1, 0.3F, box}}, {{0, 0.9F, elsewhere}, {0, 0.2F, nearby}});
  ASSERT_EQ(averaged.size(), 3u);
  EXPECT_FLOAT_EQ(averaged[0].score, 0.45F) << "half, but still the best";
  EXPECT_FLOAT_EQ(averaged[0].box.x0, 60);
  EXPECT_FLOAT_EQ(averaged[1].score, 0.4F);
  EXPECT_FLOAT_EQ(averaged[1].box.x0, 10.5F) << "a quarter of the way, as the scores say";
  EXPECT_FLOAT_EQ(averaged[1].box.y1, 50);
  EXPECT_FLOAT_EQ(averaged[2].score, 0.15F) << "another class is another object";
  EXPECT_EQ(averaged[2].class_id, 1);
}

TEST(AverageDetections, ObjectsAreNotJoinedWithWeakSecondBoxesOfThemselves) {
  const ImageBox box{0, 0, 20, 40}, second{0, 0, 20, 41}, same{2, 0, 22, 40};
  const std::vector<Detection> averaged =
      AverageDetections({{0, 0.8F, box}}, {{0, 0.6F, same}, {0, 0.02F, second}});
  ASSERT_EQ(averaged.size(), 2u);
  EXPECT_FLOAT_EQ(averaged[0].score, 0.7F);
  EXPECT_FLOAT_EQ(averaged[1].score, 0.01F);
}

TEST(AverageDetections, NothingAndNothingIsNothing) {
  EXPECT_TRUE(AverageDetections({}, {}).empty());
  EXPECT_FLOAT_EQ(AverageDetections({{0, 0, {0, 0, 9, 9}}}, {{0, 0, {0, 0, 9, 9}}})[0].box.x1, 9);
}

// Finds the bright rectangle, more certainly in the left half of the picture.
class LeftFinder : public Detector {
 public:
  LeftFinder() : Detector({"thing"}, {96, 96}, "left") {}

  StatusOr<Detections> DetectInImage(const cv::Mat& image) override {
    if (++passes > passes_that_work) return Status::Error("broken");
    const cv::Rect box = cv::boundingRect(image > 128);
    const float score = box.x + box.width / 2 < image.cols / 2 ? 0.9F : 0.5F;
    Detections found;
    if (score >= confidence)
      found.objects.push_back({0,
                               score,
                               {static_cast<float>(box.x), static_cast<float>(box.y),
                                static_cast<float>(box.br().x), static_cast<float>(box.br().y)}});
    return found;
  }
  void set_confidence(double c) override { confidence = c; }

  double confidence = 0;
  int passes = 0, passes_that_work = 100;
};

cv::Mat Picture() {
  cv::Mat picture(40, 61, CV_8UC1, cv::Scalar(20));
  cv::rectangle(picture, cv::Rect(5, 8, 12, 20), cv::Scalar(250), cv::FILLED);
  return picture;
}

TEST(MirrorAverage, FindsTheSamePlaceInBothLooks) {
  MirrorAverage average(std::make_unique<LeftFinder>(), 0.25);
  EXPECT_THAT(average.description(), testing::HasSubstr("mirrored"));
  const Detections found = average.DetectInImage(Picture()).value();
  ASSERT_EQ(found.objects.size(), 1u);
  EXPECT_FLOAT_EQ(found.objects[0].score, 0.7F);
  EXPECT_FLOAT_EQ(found.objects[0].box.x0, 5);
  EXPECT_FLOAT_EQ(found.objects[0].box.x1, 17);
  EXPECT_FLOAT_EQ(found.objects[0].box.y0, 8);
}

TEST(MirrorAverage, ReportsFromTheConfidenceOnButAveragesWeakerOnes) {
  auto finder = std::make_unique<LeftFinder>();
  const LeftFinder& inner = *finder;
  MirrorAverage average(std::move(finder), 0.75);
  EXPECT_NEAR(inner.confidence, 0.01, 1e-9);
  EXPECT_TRUE(average.DetectInImage(Picture()).value().objects.empty());
  average.set_confidence(0.65);
  EXPECT_EQ(average.DetectInImage(Picture()).value().objects.size(), 1u);
  average.set_confidence(0.001);
  EXPECT_NEAR(inner.confidence, 0.001, 1e-9);
}

TEST(MirrorAverage, AFailureOfEitherLookIsReported) {
  for (const int passes : {0, 1}) {
    auto finder = std::make_unique<LeftFinder>();
    finder->passes_that_work = passes;
    MirrorAverage average(std::move(finder), 0.25);
    EXPECT_EQ(average.DetectInImage(Picture()).message(), "broken");
  }
}

}  // namespace
}  // namespace msf
