// msf-slam simulate: renders a scenario to a data set folder.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include "apps/arguments.h"
#include "apps/command.h"
#include "io/dataset_writer.h"
#include "simulation/cast.h"
#include "simulation/simulator.h"
#include "util/options.h"
#include "util/progress.h"

namespace msf {
namespace {

// The resolved scenario; every folder that this command writes holds it.
constexpr char kScenarioFile[] = "simulation.yaml";

constexpr char kActorsHeader[] =
    "# what moves and is visible: x and y are the first and the last column and row that show it\n"
    "# timestamp actor class visible_px x_min y_min x_max y_max\n";

struct SimulateArguments {
  std::string scenario;
  std::string folder;
  uint64_t seed = 1;
  int frames = 0;
  std::vector<std::string> settings;
  bool without_actors = false;
};

// The lines of actors.txt for one frame.
std::string DescribeActors(const SimulatedFrame& simulated,
                           const std::vector<std::string>& classes) {
  std::string lines;
  const std::vector<VisibleActor> visible = FindVisibleActors(simulated.mask);
  for (const VisibleActor& actor : visible) {
    lines += fmt::format("{:.6f} {} {} {} {} {} {} {}\n", simulated.frame->time_s, actor.label,
                         classes.at(actor.label - 1), actor.num_pixels, actor.box.x, actor.box.y,
                         actor.box.br().x - 1, actor.box.br().y - 1);
  }
  return lines;
}

void Simulate(const SimulateArguments& arguments) {
  Scenario scenario = Require(LoadScenario(arguments.scenario));
  for (const std::string& setting : arguments.settings) Require(SetOption(setting, scenario));
  if (arguments.without_actors) scenario.actors.clear();
  if (arguments.frames > 0) scenario.duration_s = arguments.frames / scenario.fps;
  DatasetWriter writer = Require(DatasetWriter::Create(arguments.folder, kScenarioFile));
  Simulator simulator = Require(Simulator::Create(scenario, arguments.seed));
  Require(writer.AddFile(kScenarioFile, fmt::format("# seed {}\n{}\n", arguments.seed,
                                                    YAML::Dump(OptionsToYaml(scenario)))));

  const int num_frames = simulator.num_frames();
  const bool has_actors = !simulator.actor_classes().empty();
  std::string actors = kActorsHeader;
  Progress progress("simulate", "frames", num_frames);
  for (int i = 0; i < num_frames; ++i) {
    const SimulatedFrame simulated = simulator.Render(i);
    Require(writer.AddFrame(*simulated.frame, has_actors ? simulated.mask : cv::Mat()));
    actors += DescribeActors(simulated, simulator.actor_classes());
    progress.Update(i + 1);
  }
  if (has_actors) Require(writer.AddFile("actors.txt", actors));
  Require(writer.Finish(simulator.GroundTruth()));
  std::cout << fmt::format("{}: {} frames of scenario {}, seed {}\n", arguments.folder, num_frames,
                           scenario.name, arguments.seed);
}

}  // namespace

void AddSimulateCommand(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("simulate", "Render a synthetic RGB-D sequence with exact ground truth");
  auto arguments = std::make_shared<SimulateArguments>();
  command
      ->add_option("SCENARIO", arguments->scenario,
                   fmt::format("a YAML file or one of: {}", fmt::join(ScenarioNames(), ", ")))
      ->required();
  command->add_option("--out", arguments->folder, "folder to write, in TUM layout")->required();
  command
      ->add_option("--seed", arguments->seed,
                   "another seed gives another world, noise and hand tremor")
      ->check(Seed())
      ->capture_default_str();
  command->add_option("--frames", arguments->frames, "stop after this many frames")
      ->check(CLI::Range(1, 1000000));
  command->add_option("--set", arguments->settings,
                      "override the scenario, e.g. color.blur_samples=4");
  command->add_flag("--without-actors", arguments->without_actors,
                    "leave out what moves; world, camera path and noise stay as they are");
  command->footer("Keys of a scenario, with defaults:\n" + DescribeOptions<Scenario>());
  command->callback([arguments] { Simulate(*arguments); });
}

}  // namespace msf
