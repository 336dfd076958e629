// A network made ready for images of one size: kernels chosen, weights reordered, memory laid out.
#pragma once

#include <cstdlib>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "detection/graph.h"
#include "detection/step.h"
#include "detection/storage_plan.h"

namespace msf {

struct CompileOptions {
  int64_t height = 320;  // of the input image, pixels
  int64_t width = 416;
  NetworkPrecision precision = NetworkPrecision::kFloat32;
  int threads = 1;
  // One dense convolution instead of parallel branches (branch_merging.h); kAuto: where it is
  // faster on this processor.
  enum class Merging { kNever, kAuto, kAlways } merging = Merging::kAuto;
  bool float_input = false;  // the image is given as floats (tests), not as 8-bit pixels
  bool keep_values = false;  // no value's memory is reused, so that inner_values() keep theirs
                             // (calibration, tests)
};

// A result of the network as float32, or a value inside it.
struct NetworkOutput {
  std::string name;
  Shape shape;                 // in the order of the model file, e.g. [1, C, H, W]
  bool channels_last = false;  // memory order of an image: [H][W][C] instead of [C][H][W]
  const float* data = nullptr;

  std::span<const float> numbers() const { return {data, static_cast<size_t>(NumElements(shape))}; }
};

// Run() allocates nothing. Not to be used by two threads at once.
class CompiledNetwork {
 public:
  // Fixes the size, fuses and compiles. Precision kInt8 needs the activation ranges that
  // calibration put into the model's metadata. An error names the file and, when a node is the
  // reason, the node.
  static StatusOr<std::unique_ptr<CompiledNetwork>> Compile(const Graph& graph,
                                                            const CompileOptions& options);

  // The image: RGB, 8 bits, [height][width][3]; the network sees it as 0..1.
  uint8_t* pixels();
  // With float_input: [3][height][width], RGB in 0..1.
  float* float_input();

  Status Run();

  // In the order of the model file; valid until the next Run().
  const std::vector<NetworkOutput>& outputs() const { return outputs_; }

  // With keep_values and kFloat32: every image-shaped value inside the network.
  const std::vector<NetworkOutput>& inner_values() const { return inner_values_; }
  const std::string& input_name() const;

  // Memory for values and working space, in bytes, without weights.
  size_t activation_bytes() const { return activation_bytes_; }
  // Convolutions that multiply 8-bit numbers, and all.
  int num_int8_convolutions() const { return num_int8_convolutions_; }
  int num_convolutions() const { return num_convolutions_; }
  // The share of multiply-adds that are done in 8 bits, 0 to 1.
  double int8_share() const { return num_products_ > 0 ? num_int8_products_ / num_products_ : 0; }

 private:
  friend class NetworkBuilder;
  struct FreeMemory {
    void operator()(void* memory) const { std::free(memory); }
  };
  using Block = std::unique_ptr<void, FreeMemory>;

  CompiledNetwork() = default;

  Graph graph_;
  int threads_ = 1;
  Block activations_, scratch_;
  size_t activation_bytes_ = 0;
  int num_convolutions_ = 0, num_int8_convolutions_ = 0;
  double num_products_ = 0, num_int8_products_ = 0;  // of convolutions
  void* input_ = nullptr;
  std::vector<std::unique_ptr<Step>> steps_;
  std::vector<NetworkOutput> outputs_;
  std::vector<NetworkOutput> inner_values_;
};

// Metadata key under which a model file carries its activation ranges, and the text form: a JSON
// object {"name": [low, high, [mean of channel 0, ...]], ...}, means where they are known.
inline constexpr const char* kActivationRangesKey = "msf_activation_ranges";
std::string FormatActivationRanges(const ActivationRanges& ranges);
StatusOr<ActivationRanges> ParseActivationRanges(const std::string& text);

}  // namespace msf
