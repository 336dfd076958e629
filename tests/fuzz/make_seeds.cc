// Writes small valid models as seeds for the fuzzers: make_seeds FOLDER.
#include <filesystem>
#include <fstream>

#include "detection/test_networks.h"

int main(int argc, char** argv) {
  if (argc != 2) return 1;
  const std::filesystem::path folder = argv[1];
  std::filesystem::create_directories(folder);
  msf::TestNetworkOptions options;
  options.base = 2;
  const auto write = [&](const char* name) {
    std::ofstream(folder / name, std::ios::binary) << msf::TestNetwork(options).builder().Bytes();
  };
  write("raw.onnx");
  options.msf = true;
  write("msf.onnx");
  options.single_output = options.attention = true;
  options.height = options.width = 32;
  write("attention.onnx");
  return 0;
}
