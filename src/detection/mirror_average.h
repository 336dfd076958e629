// Detection in pictures that are seen twice: as they are and mirrored.
#pragma once

#include <memory>
#include <vector>

#include "detection/detector.h"

namespace msf {

// What two looks at one image found, averaged: detections of one class that overlap are one object,
// with the mean of their scores and, weighted by these, of their boxes; what only one look found
// keeps half its score. Each detection joins at most one, the better ones choose first. Both lists
// and the result: best first.
std::vector<Detection> AverageDetections(const std::vector<Detection>& first,
                                         std::vector<Detection> second);

// Of a single look: what is weaker does not change a mean that anybody looks at.
inline constexpr double kLeastAveragedScore = 0.01;

// Looks at each image and at its mirror image (2 passes of the network) and averages. A network
// errs differently on the two, so objects are found that a single look ranks below what is none.
class MirrorAverage : public Detector {
 public:
  // `confidence`: as in DetectorOptions.
  MirrorAverage(std::unique_ptr<Detector> detector, double confidence);

  StatusOr<Detections> DetectInImage(const cv::Mat& image) override;
  void set_confidence(double confidence) override;

 private:
  const std::unique_ptr<Detector> detector_;
  double confidence_ = 0;
};

}  // namespace msf
