#include "apps/detector_evaluation.h"

#include <algorithm>

#include "detection/class_names.h"
#include "io/image_reader.h"

namespace msf {
namespace {

std::vector<LabeledBox> LabelsOf(const VocImage& image) {
  std::vector<LabeledBox> labels;
  for (const VocObject& o : image.objects)
    labels.push_back({o.label, {o.x0, o.y0, o.x1, o.y1}, o.difficult});
  return labels;
}

// Index of the largest object of a class that counts; the number of objects when there is none.
size_t LargestOf(const std::vector<LabeledBox>& objects, int class_id) {
  size_t largest = objects.size();
  for (size_t i = 0; i < objects.size(); ++i) {
    if (objects[i].class_id != class_id || objects[i].ignored) continue;
    if (largest == objects.size() || objects[i].box.area() > objects[largest].box.area())
      largest = i;
  }
  return largest;
}

}  // namespace

const std::vector<std::string>& PascalVocClassNames() {
  static const std::vector<std::string> kNames = {
      "aeroplane", "bicycle",     "bird",  "boat",        "bottle", "bus",      "car",
      "cat",       "chair",       "cow",   "diningtable", "dog",    "horse",    "motorbike",
      "person",    "pottedplant", "sheep", "sofa",        "train",  "tvmonitor"};
  return kNames;
}

StatusOr<DetectorEvaluation> DetectorEvaluation::Make(Detector& detector,
                                                      std::vector<VocImage> images,
                                                      std::function<void(int)> progress) {
  const std::vector<int> to_voc = MatchClasses(detector.class_names(), PascalVocClassNames());
  if (std::all_of(to_voc.begin(), to_voc.end(), [](int id) { return id < 0; })) {
    return Status::Error(
        "none of the detector's classes is one of PASCAL VOC, so it cannot be evaluated there");
  }
  return DetectorEvaluation(detector, std::move(images), to_voc, std::move(progress));
}

StatusOr<std::vector<ScoredImage>> DetectorEvaluation::Run(
    const std::function<LabeledPicture(LabeledPicture, size_t)>& vary) {
  std::vector<ScoredImage> scored;
  ImageReader reader;
  for (size_t i = 0; i < images_.size(); ++i) {
    StatusOr<cv::Mat> pixels = reader.ReadColor(images_[i].file);
    if (!pixels.ok()) return pixels.status();
    const LabeledPicture seen = vary({*pixels, LabelsOf(images_[i])}, i);
    StatusOr<Detections> found = detector_.DetectInImage(seen.pixels);
    if (!found.ok()) return found.status();
    ScoredImage result{seen.objects, {}};
    for (Detection d : found->objects) {
      d.class_id = to_voc_[static_cast<size_t>(d.class_id)];
      if (d.class_id >= 0) result.found.push_back(d);
    }
    scored.push_back(std::move(result));
    progress_(++done_);
  }
  return scored;
}

StatusOr<std::vector<ScoredImage>> DetectorEvaluation::RunUpright() {
  return Run([](LabeledPicture picture, size_t) { return picture; });
}

StatusOr<std::vector<ScoredImage>> DetectorEvaluation::RunRotated(double degrees, double q) {
  return Run(
      [degrees, q](const LabeledPicture& picture, size_t) { return Rotate(picture, degrees, q); });
}

StatusOr<std::vector<ScoredImage>> DetectorEvaluation::RunCut(int class_id, double fraction) {
  return Run([class_id, fraction](LabeledPicture picture, size_t i) {
    const size_t target = LargestOf(picture.objects, class_id);
    if (target == picture.objects.size()) return picture;
    return CutObject(picture, target, fraction, static_cast<ImageSide>(i % 4));
  });
}

}  // namespace msf
