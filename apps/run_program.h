// How a program of commands ends: 0, or a sentence on stderr and something else.
#pragma once

#include <exception>
#include <iostream>

#include "apps/command.h"

namespace msf {

// Printing is part of the work: when stdout takes no more, success becomes a failure.
inline int FinishOutput(int exit_code) {
  if (std::cout.flush() || exit_code != 0) return exit_code;
  std::cerr << "msf-slam: not all of the output could be written to stdout; is the disk full, or "
               "stdout closed?\n";
  return 1;
}

inline int RunProgram(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    return FinishOutput(0);
  } catch (const CLI::ParseError& error) {
    return FinishOutput(app.exit(error));
  } catch (const CommandFailure& failure) {
    std::cerr << "msf-slam: " << failure.what() << "\n";
  } catch (const std::exception& error) {
    std::cerr << "msf-slam: internal error, please report it: " << error.what() << "\n";
  }
  return 1;
}

}  // namespace msf
