// Those who want to know what happens: viewers, loggers, recorders. The system never asks whether
// they exist.
#pragma once

#include "dynamic/dynamic_filter.h"
#include "loop_closing/loop_closer.h"
#include "mapping/local_mapper.h"
#include "tracking/tracking_result.h"

namespace msf {

// The calls come from the thread on which the thing happened; they should return quickly and must
// not call the system.
class Observer {
 public:
  virtual ~Observer() = default;
  // What was found to move, after the frame was tracked on the rest and before OnFrame().
  // `features`: all, also those that are not used. Not called in mode off.
  virtual void OnDynamics(const RgbdFrame& /*frame*/, const FrameFeatures& /*features*/,
                          const DynamicResult& /*result*/) {}
  virtual void OnFrame(const TrackingResult& /*result*/) {}
  virtual void OnKeyFrameMapped(KeyFrameId /*id*/, const MappingSummary& /*summary*/) {}
  // A loop was closed or two maps became one.
  virtual void OnPlaceRecognized(const LoopClosingSummary& /*summary*/) {}
};

}  // namespace msf
