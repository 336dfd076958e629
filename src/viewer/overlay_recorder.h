// Records what the filter of dynamic points sees as a video or a folder of pictures.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "system/observer.h"
#include "system/worker.h"
#include "viewer/dynamics_drawing.h"
#include "viewer/picture_writer.h"

namespace msf {

// Draws and encodes on a thread of its own.
class OverlayRecorder : public Observer {
 public:
  // See PictureWriter. `live`: pictures are left out rather than letting tracking wait for their
  // drawing.
  static StatusOr<std::shared_ptr<OverlayRecorder>> Create(const std::filesystem::path& target,
                                                           double fps, bool live);

  void OnDynamics(const RgbdFrame& frame, const FrameFeatures& features,
                  const DynamicResult& result) override;
  void OnFrame(const TrackingResult& result) override;

  // Waits for the last picture and puts the recording in its place. Nothing may be observed
  // afterwards.
  Status Finish();
  // Pictures left out because drawing did not keep up.
  int num_left_out() const { return num_left_out_; }

 private:
  OverlayRecorder(std::unique_ptr<PictureWriter> writer, bool live);

  const std::unique_ptr<PictureWriter> writer_;
  const bool live_;
  std::optional<DynamicsView> next_;  // waits for its pose
  int num_left_out_ = 0;
  Status written_;  // of the worker's thread until Finish()
  std::unique_ptr<Worker<DynamicsView>> worker_;
};

}  // namespace msf
