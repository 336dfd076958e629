// Running a detector over a labelled data set and scoring it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "detection/detection_metrics.h"
#include "detection/detector.h"
#include "detection/image_variation.h"
#include "io/voc_dataset.h"
#include "util/status.h"

namespace msf {

// The 20 classes of PASCAL VOC in their customary order.
const std::vector<std::string>& PascalVocClassNames();

// Scores a detector on images labelled with PASCAL VOC classes. The detector's classes are matched
// by name ("airplane" is "aeroplane"); what it finds of other classes does not count.
class DetectorEvaluation {
 public:
  // `progress(done)` counts images. An error when no class of the detector is one of VOC.
  static StatusOr<DetectorEvaluation> Make(Detector& detector, std::vector<VocImage> images,
                                           std::function<void(int)> progress);

  // The images as they are; the results carry VOC class ids.
  StatusOr<std::vector<ScoredImage>> RunUpright();
  // Turned pictures, with the boxes of TurnBox(q).
  StatusOr<std::vector<ScoredImage>> RunRotated(double degrees, double q);
  // In every image with objects of `class_id` the largest of them is cut by a side of the picture,
  // each side in turn.
  StatusOr<std::vector<ScoredImage>> RunCut(int class_id, double fraction);

  const std::vector<VocImage>& images() const { return images_; }

 private:
  DetectorEvaluation(Detector& detector, std::vector<VocImage> images, std::vector<int> to_voc,
                     std::function<void(int)> progress)
      : detector_(detector),
        images_(std::move(images)),
        to_voc_(std::move(to_voc)),
        progress_(std::move(progress)) {}

  // `vary(picture, index)` yields what the detector sees.
  StatusOr<std::vector<ScoredImage>> Run(
      const std::function<LabeledPicture(LabeledPicture, size_t)>& vary);

  Detector& detector_;
  std::vector<VocImage> images_;
  std::vector<int> to_voc_;  // class of the detector -> class of VOC, -1: none
  std::function<void(int)> progress_;
  int done_ = 0;
};

}  // namespace msf
