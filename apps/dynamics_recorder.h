// Keeps what the filter of dynamic points said, frame by frame.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "evaluation/dynamics_record.h"
#include "evaluation/label_files.h"
#include "system/observer.h"

namespace msf {

class DynamicsRecorder : public Observer {
 public:
  // `keep_labels`: every point and object of every frame is kept, 16 bytes per point.
  explicit DynamicsRecorder(bool keep_labels) : keep_labels_(keep_labels) {}

  void OnDynamics(const RgbdFrame& frame, const FrameFeatures& features,
                  const DynamicResult& result) override {
    last_ = MakeDynamicsRecord(result);
    if (keep_labels_) labels_.push_back(MakeLabelledFrame(frame, features, result));
  }

  // What was said about the frame just tracked; nothing in mode off. Asking twice gives nothing the
  // second time.
  std::optional<DynamicsRecord> TakeLast() { return std::exchange(last_, std::nullopt); }
  const std::vector<LabelledFrame>& labels() const { return labels_; }

 private:
  const bool keep_labels_;
  std::optional<DynamicsRecord> last_;
  std::vector<LabelledFrame> labels_;
};

}  // namespace msf
