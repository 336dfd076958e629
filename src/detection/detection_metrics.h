// How good detections are, in the terms that detection papers and the YOLOv8 tools use.
#pragma once

#include <string>
#include <vector>

#include "detection/detection.h"

namespace msf {

// An object that is really there. Finding an ignored one is neither right nor wrong.
struct LabeledBox {
  int class_id = 0;
  ImageBox box;
  bool ignored = false;
};

// One image: what is there and what was found. Class ids of both mean the same classes.
struct ScoredImage {
  std::vector<LabeledBox> truth;
  std::vector<Detection> found;
};

// A point of a precision-recall curve: all detections with at least this score.
struct OperatingPoint {
  float score = 0;
  double recall = 0;
  double precision = 1;
};

struct ClassMetrics {
  int num_objects = 0;
  double precision = 0;  // at the confidence of DetectionMetrics
  double recall = 0;
  double ap50 = 0;                    // average precision at IoU 0.50
  double ap50_95 = 0;                 // mean over IoU 0.50, 0.55, ..., 0.95
  std::vector<OperatingPoint> curve;  // at IoU 0.50, falling score
};

struct DetectionMetrics {
  std::vector<ClassMetrics> per_class;
  double confidence = 0;  // where the F1 score, averaged over the classes and smoothed, is best
  // Means over the classes that have at least `min_objects` objects.
  double precision = 0;
  double recall = 0;
  double map50 = 0;
  double map50_95 = 0;
  int num_classes = 0;  // of them
};

// Within an image and class a detection stands for the object it overlaps most, and of those that
// stand for one object the strongest is right. Average precision: area under the precision
// envelope, sampled at 101 recalls (COCO). Precision and recall: at the one confidence of a grid of
// 1000 that maximises the mean F1 score (moving average over a tenth of the grid). `min_objects` is
// at least 1.
DetectionMetrics ComputeMetrics(const std::vector<ScoredImage>& images, int num_classes,
                                int min_objects);

// Area under the envelope of a curve, by trapezia between the recalls 0, 0.01, ..., 1.
double AveragePrecision101(const std::vector<OperatingPoint>& curve);

// Recall of one class when at most `false_per_image` detections per image are wrong (IoU >= 0.5;
// strongest first, each object is found once), and the score at which that is reached.
struct RecallAtFalseRate {
  double recall = 0;
  double score = 1;
  int num_objects = 0;
  int num_found = 0;
  int num_false = 0;
};
RecallAtFalseRate ComputeRecallAtFalseRate(const std::vector<ScoredImage>& images, int class_id,
                                           double false_per_image);

// A table for people.
std::string FormatMetrics(const DetectionMetrics& metrics,
                          const std::vector<std::string>& class_names);

}  // namespace msf
