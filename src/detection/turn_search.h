// Detection in pictures of which nobody knows how the camera was held.
#pragma once

#include <memory>

#include "detection/detector.h"

namespace msf {

// Looks at a picture upright and turned in steps of 30 degrees up to a quarter turn to either side
// (7 passes of the network) and reports what it finds in the view that shows most: upright, unless
// another one is clearly better. A picture has one camera and so one turn; boxes of several views
// put together would be wrong more often. Sequences need no search: tracking knows how the camera
// is rolled (tracking/camera_roll.h).
class TurnSearch : public Detector {
 public:
  // `confidence`: as in DetectorOptions.
  TurnSearch(std::unique_ptr<Detector> detector, double confidence);

  StatusOr<Detections> DetectInImage(const cv::Mat& image) override;
  void set_confidence(double confidence) override;

 private:
  const std::unique_ptr<Detector> detector_;
  double confidence_;
};

}  // namespace msf
