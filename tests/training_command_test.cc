// `msf-slam detector export` as a user meets it.
#include <gtest/gtest.h>
#include <torch/types.h>

#include "detection/onnx_reader.h"
#include "io/test_folder.h"
#include "tests/program.h"
#include "training/model_config.h"
#include "training/network.h"

namespace msf {
namespace {

// Untrained weights; those of another seed are others.
NamedTensors Weights(uint64_t seed) {
  return Network(BuildModelGraph(*LoadModelConfig("yolov8n")), seed).State();
}

double LargestDifference(const NamedTensors& a, const NamedTensors& b) {
  double largest = 0;
  for (const auto& [name, tensor] : a)
    largest = std::max(largest, (tensor - b.at(name)).abs().max().item<double>());
  return largest;
}

TEST(ExportCommand, WritesBlendedWeightsThatCanBeExportedInTurn) {
  const TestFolder folder;
  const std::string path = folder.path().string() + "/";
  const NamedTensors a = Weights(1), b = Weights(2);
  ASSERT_TRUE(SaveTensors(path + "a.pt", a).ok());
  ASSERT_TRUE(SaveTensors(path + "b.pt", b).ok());
  const std::string command = "detector export --model yolov8n --weights " + path;
  const Outcome blended = RunProgram(command + "a.pt --blend " + path +
                                     "b.pt --blend-share 0.25 --out " + path + "c.pt");
  ASSERT_EQ(blended.exit_code, 0) << blended.output;
  const StatusOr<NamedTensors> c = LoadTensors(path + "c.pt");
  ASSERT_TRUE(c.ok()) << c.message();
  ASSERT_EQ(c->size(), a.size());
  EXPECT_GT(LargestDifference(*c, a), 1e-3);
  NamedTensors expected;
  for (const auto& [name, tensor] : a) expected[name] = 0.75 * tensor + 0.25 * b.at(name);
  EXPECT_LT(LargestDifference(expected, *c), 1e-6);

  const Outcome exported = RunProgram(command + "c.pt --out " + path + "c.onnx");
  ASSERT_EQ(exported.exit_code, 0) << exported.output;
  EXPECT_TRUE(ReadOnnx(path + "c.onnx").ok());
}

TEST(ExportCommand, SaysWhatIsWrongWithTheWeights) {
  const TestFolder folder;
  const std::string path = folder.path().string() + "/";
  ExpectSentence(RunProgram("detector export --model yolov8n --weights " + path + "none.pt --out " +
                            path + "c.pt"),
                 "none.pt");
  EXPECT_FALSE(std::filesystem::exists(path + "c.pt"));
}

}  // namespace
}  // namespace msf
