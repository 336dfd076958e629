// The one program: a thin dispatcher over the subcommands.
#include <exception>
#include <iostream>

#include "apps/command.h"

int main(int argc, char** argv) {
  CLI::App app("MSF-SLAM: real-time RGB-D SLAM that keeps its accuracy while people walk through the picture", "msf-slam");
  app.require_subcommand(1);
  msf::AddEvaluateCommand(app);
  msf::AddSimulateCommand(app);
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  } catch (const msf::CommandFailure& failure) {
    std::cerr << "msf-slam: " << failure.what() << "\n";
  } catch (const std::exception& error) {
    std::cerr << "msf-slam: internal error, please report it: " << error.what() << "\n";
  }
  return 1;
}
