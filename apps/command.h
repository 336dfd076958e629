// What every subcommand of msf-slam has in common.
#pragma once

#include <CLI/CLI.hpp>
#include <stdexcept>
#include <string>

#include "util/status.h"

namespace msf {

// Ends a command with a sentence for the user and a non-zero exit.
class CommandFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Throws CommandFailure with the sentence of a status that is not ok.
inline void Require(const Status& status) {
  if (!status.ok()) throw CommandFailure(status.message());
}

template <typename T>
T Require(StatusOr<T> result) {
  Require(result.status());
  return std::move(result).value();
}

// Each adds one subcommand (its file: apps/<name>_command.cc).
void AddEvaluateCommand(CLI::App& app);
void AddSimulateCommand(CLI::App& app);
void AddVocabularyCommands(CLI::App& app);
void AddDetectCommand(CLI::App& app);
void AddDetectorCommands(CLI::App& app);
void AddRunCommand(CLI::App& app);
void AddBenchCommand(CLI::App& app);

}  // namespace msf
