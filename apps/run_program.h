// How a program of commands ends: 0, or a sentence on stderr and something else.
#pragma once

#include <exception>
#include <iostream>

#include "apps/command.h"

namespace msf {

inline int RunProgram(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  } catch (const CommandFailure& failure) {
    std::cerr << "msf-slam: " << failure.what() << "\n";
  } catch (const std::exception& error) {
    std::cerr << "msf-slam: internal error, please report it: " << error.what() << "\n";
  }
  return 1;
}

}  // namespace msf
