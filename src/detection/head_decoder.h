// From a network's outputs to boxes.
#pragma once

#include <vector>

#include "detection/compiled_network.h"
#include "detection/detection.h"

namespace msf {

// Understands two forms:
// raw heads: per stride s in 8, 16, 32 the outputs "box_s" [1, 64, h, w] (distributions over 16
// bins for the four sides, in strides
//   from the cell's centre: left, top, right, bottom) and "class_s" [1, classes, h, w] (logits);
// single output: [1, 4 + classes, anchors] with centre x, y, width, height in network pixels and
// scores 0..1.
class HeadDecoder {
 public:
  // Looks at names and shapes of the outputs; an error says what a usable model has.
  static StatusOr<HeadDecoder> Make(const std::vector<NetworkOutput>& outputs,
                                    const std::string& source);

  int num_classes() const { return num_classes_; }

  // Detections in network pixels with a score of at least `confidence`. `every_class`: one for each
  // class that reaches it (for evaluation), else one per cell, for its best class.
  std::vector<Detection> Decode(const std::vector<NetworkOutput>& outputs, float confidence,
                                bool every_class) const;

  // The score of every class in every cell, in an order that is the same for every image.
  std::vector<float> Scores(const std::vector<NetworkOutput>& outputs) const;

 private:
  struct RawScale {
    size_t box = 0;  // index of the output
    size_t klass = 0;
    float stride = 8;
  };
  void DecodeScale(const RawScale& scale, const std::vector<NetworkOutput>& outputs,
                   float confidence, bool every_class, std::vector<Detection>& found) const;
  void DecodeSingle(const NetworkOutput& output, float confidence, bool every_class,
                    std::vector<Detection>& found) const;

  int num_classes_ = 0;
  std::vector<RawScale> scales_;  // empty: single output
};

}  // namespace msf
