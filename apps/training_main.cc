// The part of msf-slam that needs libtorch; the main program hands the commands over
// (detector_training_handover.cc).
#include "apps/command.h"
#include "apps/detector_training.h"
#include "apps/run_program.h"

int main(int argc, char** argv) {
  CLI::App app("Detector training of MSF-SLAM", "msf-slam");
  app.require_subcommand(1);
  msf::AddDetectorTrainCommand(app);
  msf::AddDetectorExportCommand(app);
  return msf::RunProgram(app, argc, argv);
}
