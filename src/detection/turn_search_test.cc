#include "detection/turn_search.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace msf {
namespace {

// Knows people as a bright head over a dark body: certain when the brightest spot of the picture
// lies straight above its darkest one.
class HeadFinder : public Detector {
 public:
  HeadFinder() : Detector({"person"}, {96, 96}, "heads") {}

  StatusOr<Detections> DetectInImage(const cv::Mat& image) override {
    ++passes;
    if (fails) return Status::Error("broken");
    cv::Mat grey;
    cv::GaussianBlur(image, grey, {5, 5}, 0);
    cv::Point dark, bright;
    cv::minMaxLoc(grey, nullptr, nullptr, &dark, &bright);
    const cv::Point2d up = bright - dark;
    Detections found;
    const auto score =
        static_cast<float>(-up.y / std::max(1.0, std::hypot(up.x, up.y)) * certainty);
    const cv::Rect box = cv::boundingRect(std::vector<cv::Point>{bright, dark});
    const ImageBox padded{static_cast<float>(box.x) - 12, static_cast<float>(box.y) - 12,
                          static_cast<float>(box.br().x) + 12, static_cast<float>(box.br().y) + 12};
    if (score >= confidence) found.objects.push_back({0, score, padded});
    return found;
  }
  void set_confidence(double c) override { confidence = c; }

  double certainty = 0.9, confidence = 0;
  int passes = 0;
  bool fails = false;
};

// Of 200 x 160 pixels, with the head `degrees` clockwise from straight above the body.
cv::Mat Person(double degrees) {
  cv::Mat picture(160, 200, CV_8UC1, cv::Scalar(114));
  const double angle = degrees * CV_PI / 180;
  const cv::Point body(100, 80);
  cv::circle(picture, body, 9, cv::Scalar(10), cv::FILLED);
  cv::circle(picture,
             {body.x + static_cast<int>(std::lround(50 * std::sin(angle))),
              body.y - static_cast<int>(std::lround(50 * std::cos(angle)))},
             9, cv::Scalar(240), cv::FILLED);
  return picture;
}

struct Search {
  explicit Search(double confidence, bool mirrored = false) {
    auto finder = std::make_unique<HeadFinder>();
    inner = finder.get();
    search = std::make_unique<TurnSearch>(std::move(finder), confidence, mirrored);
  }
  HeadFinder* inner;
  std::unique_ptr<TurnSearch> search;
};

TEST(TurnSearch, FindsPeopleHoweverTheCameraWasHeld) {
  for (const double degrees : {0, 60, -60, 75, -75, 90, -90}) {
    const Search s(0.25);
    const Detections found = s.search->DetectInImage(Person(degrees)).value();
    EXPECT_EQ(s.inner->passes, 9);
    ASSERT_EQ(found.objects.size(), 1u) << degrees;
    EXPECT_GT(found.objects[0].score, 0.85) << degrees;
    // The box holds the middle between body and head.
    const double angle = degrees * CV_PI / 180;
    EXPECT_TRUE(found.objects[0].box.Contains(static_cast<float>(100 + 25 * std::sin(angle)),
                                              static_cast<float>(80 - 25 * std::cos(angle))))
        << degrees;
  }
}

TEST(TurnSearch, TheViewThatShowsMostIsAveragedWithItsMirrorImage) {
  for (const double degrees : {0, 50, 90}) {
    const Search once(0.25), twice(0.25, true);
    const Detections one = once.search->DetectInImage(Person(degrees)).value();
    const Detections mean = twice.search->DetectInImage(Person(degrees)).value();
    EXPECT_EQ(twice.inner->passes, 10);
    ASSERT_EQ(mean.objects.size(), 1u) << degrees;
    EXPECT_NEAR(mean.objects[0].score, one.objects[0].score, 0.03) << degrees;
    EXPECT_GT(IntersectionOverUnion(mean.objects[0].box, one.objects[0].box), 0.75F) << degrees;
  }
}

TEST(TurnSearch, StaysUprightUnlessAnotherViewIsClearlyBetter) {
  const Search s(0.25);
  // Upright 0.9 * cos 30 degrees: 0.61 of evidence against 0.81.
  EXPECT_NEAR(s.search->DetectInImage(Person(30)).value().objects[0].score, 0.78, 0.03);
  // All too weak to tell.
  s.inner->certainty = 0.6;
  EXPECT_TRUE(s.search->DetectInImage(Person(90)).value().objects.empty());
}

TEST(TurnSearch, ReportsFromTheConfidenceOn) {
  const Search s(0.7);
  EXPECT_NEAR(s.inner->confidence, 0.2, 1e-6) << "weaker detections speak for a view, too";
  EXPECT_TRUE(s.search->DetectInImage(Person(45)).value().objects.empty()) << "upright, 0.64";
  s.search->set_confidence(0.1);
  EXPECT_EQ(s.inner->confidence, 0.1);
  EXPECT_EQ(s.search->DetectInImage(Person(45)).value().objects.size(), 1u);
}

TEST(TurnSearch, AFailureIsReported) {
  const Search s(0.25);
  s.inner->fails = true;
  EXPECT_EQ(s.search->DetectInImage(Person(0)).message(), "broken");
  EXPECT_FALSE(s.search->DetectInImage(cv::Mat()).ok());
}

}  // namespace
}  // namespace msf
