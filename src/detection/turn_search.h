// Detection in pictures of which nobody knows how the camera was held.
#pragma once

#include <memory>

#include "detection/detector.h"

namespace msf {

// Looks at a picture upright and turned in steps of 30 degrees up to a quarter turn to either side,
// then 15 degrees to both sides of the best of these views (9 passes of the network), and reports
// what it finds in the view that shows most: upright, unless another one is clearly better. A
// picture has one camera and so one turn; boxes of several views put together would be wrong more
// often. With `mirrored` that view is looked at a second time, in the mirror (mirror_average.h),
// and what is reported is the average. Sequences need no search: tracking knows how the camera is
// rolled (tracking/camera_roll.h).
class TurnSearch : public Detector {
 public:
  // `confidence`: as in DetectorOptions.
  TurnSearch(std::unique_ptr<Detector> detector, double confidence, bool mirrored);

  StatusOr<Detections> DetectInImage(const cv::Mat& image) override;
  void set_confidence(double confidence) override;

 private:
  struct View {
    double turn_rad = 0;
    Detections detections;
  };
  StatusOr<View> FindView(const cv::Mat& image);

  const std::unique_ptr<Detector> detector_;
  const bool mirrored_;
  double confidence_ = 0;
};

}  // namespace msf
