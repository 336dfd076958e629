// The subcommands of `msf-slam detector` that need libtorch.
#pragma once

#include <CLI/CLI.hpp>

namespace msf {

void AddDetectorTrainCommand(CLI::App& app);
void AddDetectorExportCommand(CLI::App& app);

// The command `detector` that the others live under, created by whoever comes first.
inline CLI::App* DetectorCommand(CLI::App& app) {
  const auto existing = app.get_subcommands(
      [](const CLI::App* command) { return command->get_name() == "detector"; });
  if (!existing.empty()) return existing.front();
  CLI::App* detector =
      app.add_subcommand("detector", "Train, evaluate, quantise and describe detectors");
  detector->require_subcommand(1);
  return detector;
}

}  // namespace msf
