// In msf-slam, the commands that need libtorch are handed over to msf-slam-training, which lies
// beside it.
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/command.h"
#include "apps/detector_training.h"

namespace msf {
namespace {

// Replaces this process by `msf-slam-training detector COMMAND ARGUMENT...`.
[[noreturn]] void HandOver(const std::string& command, const std::vector<std::string>& arguments) {
  const std::filesystem::path program =
      std::filesystem::read_symlink("/proc/self/exe").parent_path() / "msf-slam-training";
  if (!std::filesystem::exists(program)) {
    throw CommandFailure(
        "'detector " + command + "' needs the program " + program.string() +
        ", which this build left out; build with -DMSF_BUILD_TRAINING=ON (needs libtorch-dev)");
  }
  std::vector<std::string> words = {program.string(), "detector", command};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  execv(program.c_str(), argv.data());
  throw CommandFailure(program.string() + ": cannot be started: " + std::strerror(errno));
}

void AddHandOver(CLI::App& app, const std::string& name, const std::string& help) {
  CLI::App* command = DetectorCommand(app)->add_subcommand(name, help);
  command->prefix_command();
  command->set_help_flag();  // the other program explains its options
  command->callback([command, name] { HandOver(name, command->remaining()); });
}

}  // namespace

void AddDetectorTrainCommand(CLI::App& app) {
  AddHandOver(app, "train", "Train a detector on images in PASCAL VOC layout");
}

void AddDetectorExportCommand(CLI::App& app) {
  AddHandOver(app, "export", "Write a trained detector as an ONNX file");
}

}  // namespace msf
