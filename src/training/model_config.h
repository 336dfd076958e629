// The detectors we train, as configurations: YOLOv8n, the same with MSFConv, and the two
// multi-scale alternatives of the paper's table 4.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "training/model_graph.h"
#include "util/status.h"

namespace msf {

struct ModelConfig {
  std::string name = "yolov8n";
  // none, backbone (layers 0, 1, 3, 5, 7), all (16 and 19, too), or some of these, each with a
  // width of its own if need be: "3,5" or "3:1,19:0.75"
  std::string msf_placement = "none";
  double msf_width = 0.5;  // branch width over output width, where the placement names none
  std::vector<int> msf_kernels = {
      3, 5};                    // kernels of the depthwise branches beside the standard 3x3 one
  int msf_standard_kernel = 3;  // kernel of the standard branch
  std::string neck = "pan";     // pan (YOLOv8), fpn (a feature pyramid after it), hrnet
  int class_width = 0;          // hidden width of the class branch; 0: max(64, min(classes, 100))
  std::vector<std::string> classes;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("name", name, "name of the model");
    visit("msf_placement", msf_placement,
          "which stride-2 convolutions become MSFConv: none, backbone, all or layers like 3,5; "
          "with a width each: 3:1,19:0.75");
    visit("msf_width", msf_width, "branch width of MSFConv as a part of its output width");
    visit("msf_kernels", msf_kernels, "kernel sizes of MSFConv's depthwise branches");
    visit("msf_standard_kernel", msf_standard_kernel, "kernel size of MSFConv's standard branch");
    visit("neck", neck, "how scales are merged: pan (YOLOv8), fpn or hrnet");
    visit("class_width", class_width,
          "hidden width of the class branch; 0 follows the number of classes");
    visit("classes", classes, "class names in the order of the class rows");
  }
  Status Check() const;
  // The branch width over output width of the MSFConv in the layer's place; none where it stays a
  // convolution.
  std::optional<double> MsfWidthAt(int layer) const;
};

// The 20 PASCAL VOC classes in their customary (alphabetical) order, and the 80 COCO classes in the
// order of the COCO weights.
const std::vector<std::string>& VocClasses();
const std::vector<std::string>& CocoClasses();

// The COCO name of a VOC class ("sofa" -> "couch"); other names stay as they are.
std::string CocoNameOf(const std::string& voc_class);

// A built-in configuration (yolov8n, yolov8n_msf, yolov8n_msf_wide, yolov8n_msf_full, yolov8n_fpn,
// yolov8n_hrnet with 20 VOC classes; yolov8n_coco with 80), or a YAML file of ModelConfig's
// options. The error lists the names. For the same parameters and operations yolov8n_msf replaces
// all seven stride-2 convolutions by blocks half as wide as their output, yolov8n_msf_wide two by
// blocks three quarters as wide, which lose little of the trained convolutions that they take over,
// and yolov8n_msf_full one by a block as wide as it, which loses nothing (InitializeMsfLayers), and
// one of the neck by a block four fifths as wide.
StatusOr<ModelConfig> LoadModelConfig(const std::string& name_or_file);

ModelGraph BuildModelGraph(const ModelConfig& config);

}  // namespace msf
