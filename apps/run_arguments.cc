#include "apps/run_arguments.h"

#include "apps/arguments.h"
#include "apps/command.h"
#include "sensor/camera.h"
#include "util/options.h"

namespace msf {

void DeclareRunArguments(CLI::App& command, RunArguments& arguments) {
  command
      .add_option("dataset", arguments.dataset,
                  "folder in TUM layout (rgb.txt, depth.txt or associations.txt)")
      ->required();
  command.add_option("--camera", arguments.camera,
                     "tum_fr1, tum_fr2, tum_fr3, bonn, simulated or a YAML file; default: "
                     "camera.yaml in the folder");
  command.add_option("--out", arguments.out_folder,
                     "folder for the results; default: out/<name of the dataset>");
  command.add_option("--config", arguments.config_file,
                     "YAML file with options (config.yaml of an earlier run fits)");
  command
      .add_option("--set", arguments.assignments,
                  "one option as section.key=value; may be repeated")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command
      .add_option("--dynamic", arguments.dynamic,
                  "what happens to moving things: off, boxes, paper or full")
      ->type_name("MODE");
  command
      .add_option("--detector", arguments.detector,
                  "model that finds people and things: ONNX file, name of one that ships, or none")
      ->type_name("MODEL");
  auto* deterministic = command.add_flag("--deterministic", arguments.deterministic,
                                         "all stages on one thread; two runs give equal bytes");
  command.add_option("--overlay", arguments.overlay,
                     "show what was found to move: FILE.mp4 for a video, or a folder for pictures");
  command.add_flag("--labels", arguments.labels,
                   "also write labels.csv and objects.csv: what was said about every point and "
                   "object, for 'evaluate --masks'");
  CLI::Option* real_time =
      command
          .add_flag("--realtime", arguments.real_time,
                    "give frames at the pace of their time stamps, as a camera does; those for "
                    "which it has no buffer any more are dropped")
          ->excludes(deterministic);
  command
      .add_option("--buffers", arguments.buffers,
                  "frames that the camera holds while tracking is busy; 1: only the newest")
      ->check(CLI::Range(1, 1000))
      ->needs(real_time);
  command.add_option("--max-frames", arguments.max_frames, "stop after so many frames")
      ->check(CLI::Range(1, 1000000000));
  command.add_option("--seed", arguments.seed, "of everything random")->check(Seed());
  command.footer("Options (--set section.key=value), with their defaults:\n" +
                 DescribeOptions<SystemOptions>() + "\nKeys of a camera file, with defaults:\n" +
                 DescribeOptions<Camera>());
}

SystemOptions ResolveOptions(const RunArguments& arguments) {
  SystemOptions options;
  if (!arguments.config_file.empty()) Require(LoadOptions(arguments.config_file, options));
  // Frames from a disk can wait for the mapper; those of a camera cannot, whatever an earlier run
  // did.
  options.wait_for_mapping = !arguments.real_time;
  for (const std::string& assignment : arguments.assignments)
    Require(SetOption(assignment, options));
  if (!arguments.dynamic.empty()) options.dynamic.mode = arguments.dynamic;
  if (!arguments.detector.empty()) options.detector.model = arguments.detector;
  if (arguments.deterministic) options.deterministic = true;
  if (arguments.seed) options.seed = *arguments.seed;
  Require(options.Check());
  if (arguments.real_time && options.deterministic) {
    throw CommandFailure(
        "--realtime cannot be deterministic: set deterministic=false, or leave --realtime out");
  }
  if (options.dynamic.mode == "off" && (arguments.labels || !arguments.overlay.empty())) {
    throw CommandFailure(
        "--overlay and --labels tell what was found to move; with --dynamic off nothing is looked "
        "for");
  }
  return options;
}

}  // namespace msf
