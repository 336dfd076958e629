#include "viewer/overlay_recorder.h"

#include <fmt/format.h>

#include <utility>

namespace msf {
namespace {

constexpr size_t kQueue = 8;

}  // namespace

StatusOr<std::shared_ptr<OverlayRecorder>> OverlayRecorder::Create(
    const std::filesystem::path& target, double fps, bool live) {
  StatusOr<std::unique_ptr<PictureWriter>> writer = PictureWriter::Create(target, fps);
  if (!writer.ok()) return writer.status();
  return std::shared_ptr<OverlayRecorder>(new OverlayRecorder(*std::move(writer), live));
}

OverlayRecorder::OverlayRecorder(std::unique_ptr<PictureWriter> writer, bool live)
    : writer_(std::move(writer)), live_(live) {
  worker_ = std::make_unique<Worker<DynamicsView>>(kQueue, [this](const DynamicsView& view) {
    if (written_.ok()) written_ = writer_->Add(DrawDynamics(view));
  });
}

void OverlayRecorder::OnDynamics(const RgbdFrame& frame, const FrameFeatures& features,
                                 const DynamicResult& result) {
  next_ = DynamicsView{.frame = frame.id.value(),
                       .color = frame.color,
                       .points_px = features.image_px,
                       .result = result,
                       .tracking = {}};
}

void OverlayRecorder::OnFrame(const TrackingResult& result) {
  if (!next_) return;
  DynamicsView view = *std::exchange(next_, std::nullopt);
  view.tracking = fmt::format("{}, {} inliers", ToString(result.state), result.num_inliers);
  if (live_ && worker_->queued() >= static_cast<int>(kQueue)) {
    ++num_left_out_;
    return;
  }
  worker_->Push(std::move(view));
}

Status OverlayRecorder::Finish() {
  worker_->Finish();
  MSF_RETURN_IF_ERROR(worker_->health());
  MSF_RETURN_IF_ERROR(written_);
  return writer_->Finish();
}

}  // namespace msf
