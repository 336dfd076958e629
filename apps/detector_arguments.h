// Command-line options that choose and set up a detector.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "apps/command.h"
#include "detection/detector.h"
#include "detection/mirror_average.h"
#include "detection/turn_search.h"

namespace msf {

struct DetectorArguments {
  DetectorOptions options;
  std::string size;  // WIDTHxHEIGHT, empty: the options' own
  std::string held = "upright";
  bool mirrored = false;

  // With the options for single pictures: how they are looked at, and which of two boxes counts.
  void AddForPictures(CLI::App& command) {
    AddTo(command);
    command
        .add_option("--held", held,
                    "how the camera was held: upright, or any: 9 ways up are tried for each "
                    "picture and the one that shows most is taken")
        ->capture_default_str()
        ->check(CLI::IsMember({"upright", "any"}));
    command.add_flag("--mirrored,!--not-mirrored", mirrored,
                     fmt::format("look a second time, in the mirror, and average what both looks "
                                 "show (default: {})",
                                 mirrored ? "yes" : "no"));
    command
        .add_option("--overlap-decay", options.overlap_decay,
                    "boxes that a better one of their class overlaps lose score by exp(-iou^2 / "
                    "this); 0: they keep it, as with the YOLOv8 tools")
        ->capture_default_str();
  }

  void AddTo(CLI::App& command) {
    command
        .add_option("--model", options.model,
                    "ONNX file, or the name of a model that comes with MSF-SLAM")
        ->capture_default_str();
    command.add_option("--classes", options.classes,
                       "file with one class name per line, when the model has none");
    command.add_option("--backend", options.backend, "onednn or opencv")->capture_default_str();
    command.add_option("--precision", options.precision, "auto, fp32, bf16 or int8")
        ->capture_default_str();
    command.add_option("--size", size, "input of the network, WIDTHxHEIGHT in multiples of 32");
    command.add_option("--threads", options.threads, "threads of the network")
        ->check(CLI::Range(1, 256))
        ->capture_default_str();
  }

  // The detector, or CommandFailure.
  std::unique_ptr<Detector> Make() {
    if (!size.empty()) ReadSize();
    std::unique_ptr<Detector> detector = Require(MakeDetector(options));
    if (held == "any")
      return std::make_unique<TurnSearch>(std::move(detector), options.confidence, mirrored);
    if (mirrored) return std::make_unique<MirrorAverage>(std::move(detector), options.confidence);
    return detector;
  }

 private:
  // `size` into the options; MakeDetector looks whether they are multiples of 32.
  void ReadSize() {
    const char* end = size.data() + size.size();
    const auto [x, bad_width] = std::from_chars(size.data(), end, options.width);
    if (bad_width == std::errc() && x != end && *x == 'x') {
      const auto [rest, bad_height] = std::from_chars(x + 1, end, options.height);
      if (bad_height == std::errc() && rest == end &&
          std::min(options.width, options.height) >= 32 &&
          std::max(options.width, options.height) <= 4096)
        return;
    }
    throw CommandFailure(fmt::format(
        "--size needs the form WIDTHxHEIGHT, e.g. 416x320, of 32 to 4096 pixels, not '{}'", size));
  }
};

}  // namespace msf
