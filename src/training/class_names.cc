#include <map>

#include "training/model_config.h"

namespace msf {

const std::vector<std::string>& VocClasses() {
  static const std::vector<std::string> kClasses = {
      "aeroplane", "bicycle",     "bird",  "boat",        "bottle", "bus",      "car",
      "cat",       "chair",       "cow",   "diningtable", "dog",    "horse",    "motorbike",
      "person",    "pottedplant", "sheep", "sofa",        "train",  "tvmonitor"};
  return kClasses;
}

const std::vector<std::string>& CocoClasses() {
  static const std::vector<std::string> kClasses = {
      "person",        "bicycle",      "car",
      "motorcycle",    "airplane",     "bus",
      "train",         "truck",        "boat",
      "traffic light", "fire hydrant", "stop sign",
      "parking meter", "bench",        "bird",
      "cat",           "dog",          "horse",
      "sheep",         "cow",          "elephant",
      "bear",          "zebra",        "giraffe",
      "backpack",      "umbrella",     "handbag",
      "tie",           "suitcase",     "frisbee",
      "skis",          "snowboard",    "sports ball",
      "kite",          "baseball bat", "baseball glove",
      "skateboard",    "surfboard",    "tennis racket",
      "bottle",        "wine glass",   "cup",
      "fork",          "knife",        "spoon",
      "bowl",          "banana",       "apple",
      "sandwich",      "orange",       "broccoli",
      "carrot",        "hot dog",      "pizza",
      "donut",         "cake",         "chair",
      "couch",         "potted plant", "bed",
      "dining table",  "toilet",       "tv",
      "laptop",        "mouse",        "remote",
      "keyboard",      "cell phone",   "microwave",
      "oven",          "toaster",      "sink",
      "refrigerator",  "book",         "clock",
      "vase",          "scissors",     "teddy bear",
      "hair drier",    "toothbrush"};
  return kClasses;
}

std::string CocoNameOf(const std::string& voc_class) {
  static const std::map<std::string, std::string> kRenamed = {
      {"aeroplane", "airplane"}, {"motorbike", "motorcycle"},
      {"sofa", "couch"},         {"diningtable", "dining table"},
      {"tvmonitor", "tv"},       {"pottedplant", "potted plant"}};
  const auto found = kRenamed.find(voc_class);
  return found == kRenamed.end() ? voc_class : found->second;
}

}  // namespace msf
