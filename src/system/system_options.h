// Every option of the system, section by section (a section is a room).
#pragma once

#include <string>

#include "detection/detector.h"
#include "dynamic/dynamic_options.h"
#include "feature/orb_extractor.h"
#include "loop_closing/loop_closing_options.h"
#include "mapping/mapping_options.h"
#include "system/detection_source.h"
#include "tracking/relocalizer.h"
#include "tracking/tracking_options.h"

namespace msf {

struct SystemOptions {
  bool deterministic = false;
  uint64_t seed = 0;
  std::string vocabulary;
  bool wait_for_mapping = false;
  bool final_bundle = true;
  // model "none": no detector; motion and depth alone tell what moves.
  DetectorOptions detector;
  DetectionScheduleOptions detection;
  DynamicOptions dynamic;
  OrbOptions feature;
  NoiseOptions noise;
  TrackingOptions tracking;
  RelocalizationOptions relocalization;
  MappingOptions mapping;
  LoopClosingOptions loop_closing;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("deterministic", deterministic,
          "all stages inline on one thread: two runs give equal bytes");
    visit("seed", seed, "of everything random");
    visit("vocabulary", vocabulary, "file of visual words; empty: the one that ships");
    visit("wait_for_mapping", wait_for_mapping,
          "tracking waits while keyframes queue up: for recordings, which can be read faster than "
          "they can be mapped; `run` does so without --realtime, and only --set overrules it");
    visit("final_bundle", final_bundle,
          "adjust the whole map once more when the last frame has been seen");
    visit("detector", detector, "");
    visit("detection", detection, "");
    visit("dynamic", dynamic, "");
    visit("feature", feature, "");
    visit("noise", noise, "");
    visit("tracking", tracking, "");
    visit("relocalization", relocalization, "");
    visit("mapping", mapping, "");
    visit("loop_closing", loop_closing, "");
  }
  bool WantsDetector() const { return dynamic.mode != "off" && detector.model != "none"; }
  // The first value that makes no sense, as a sentence.
  Status Check() const;
};

}  // namespace msf
