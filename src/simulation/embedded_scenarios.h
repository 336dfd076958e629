// The scenario files of the project, compiled in, so that their names work wherever the program is.
#pragma once

#include <map>
#include <string>

namespace msf {

// Name to YAML text. The source is made from scenarios/*.yaml when the build is configured.
const std::map<std::string, std::string>& EmbeddedScenarios();

}  // namespace msf
