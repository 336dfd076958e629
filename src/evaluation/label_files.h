// labels.csv and objects.csv of a run: what the filter of dynamic points said about every feature
// of every frame.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "dynamic/dynamic_filter.h"
#include "util/status.h"

namespace msf {

struct LabelledPoint {
  float x_px = 0, y_px = 0;  // in the image as it was taken
  float static_probability = 1;
  PointReason reason = PointReason::kStatic;
};

struct LabelledObject {
  int id = 0;
  std::string name;  // of the class
  std::string kind, state;
  bool removed = false;
  bool bridged = false;  // followed, but not among the newest detections
  float score = 0;
  ImageBox box;
};

struct LabelledFrame {
  int64_t frame = 0;
  double time_s = 0;
  std::vector<LabelledPoint> points;
  std::vector<LabelledObject> objects;
};

LabelledFrame MakeLabelledFrame(const RgbdFrame& frame, const FrameFeatures& features,
                                const DynamicResult& result);

// frame,time_s,x,y,reason,static_probability: one row per feature.
Status WriteLabels(const std::filesystem::path& file, const std::vector<LabelledFrame>& frames);
// frame,time_s,id,class,kind,state,removed,bridged,score,x0,y0,x1,y1: one row per object.
Status WriteObjects(const std::filesystem::path& file, const std::vector<LabelledFrame>& frames);

// Reads a labels.csv and the objects.csv beside it, if there is one. Errors name file and line: not
// the columns above, or a value that none of these can have (a point outside of any image).
StatusOr<std::vector<LabelledFrame>> ReadLabels(const std::filesystem::path& file);

// A text as a cell of a CSV row: in quotes, with inner quotes doubled, and on one line.
std::string QuotedForCsv(std::string_view text);

}  // namespace msf
