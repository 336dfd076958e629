// The one program: a thin dispatcher over the subcommands.
#include "apps/command.h"
#include "apps/detector_training.h"
#include "apps/run_program.h"
#include "bench/machine.h"

int main(int argc, char** argv) {
  CLI::App app(
      "MSF-SLAM: real-time RGB-D SLAM that keeps its accuracy while people walk through the "
      "picture",
      "msf-slam");
  app.require_subcommand(1);
  app.set_version_flag("--version", msf::ReadBuildInfo().ToString());
  msf::AddRunCommand(app);
  msf::AddEvaluateCommand(app);
  msf::AddSimulateCommand(app);
  msf::AddBenchCommand(app);
  msf::AddVocabularyCommands(app);
  msf::AddDetectCommand(app);
  msf::AddDetectorCommands(app);
  msf::AddDetectorTrainCommand(app);
  msf::AddDetectorExportCommand(app);
  return msf::RunProgram(app, argc, argv);
}
