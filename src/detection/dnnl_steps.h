// The operators that oneDNN computes: convolutions and pools on single images that lie channels
// last.
#pragma once

#include <memory>
#include <vector>

#include "detection/graph.h"
#include "detection/step.h"
#include "detection/storage.h"
#include "detection/window.h"

namespace msf {

// A convolution with its epilogue. `compute` is the format of the multiplications: kUint8 means
// 8-bit inputs with 8-bit weights that have one scale per output channel; the input must then be
// stored as kUint8, else in `compute` itself. The addend is never kUint8.
struct ConvolutionSpec {
  Shape input_shape;
  Shape output_shape;
  Window window;
  int64_t group = 1;
  const Tensor* weights = nullptr;  // [out, in / group, height, width]
  const Tensor* bias = nullptr;     // [out] or none
  Epilogue epilogue;
  NumberFormat compute = NumberFormat::kFloat32;
  Storage input, output, addend;
};

struct PoolSpec {
  Shape input_shape;
  Shape output_shape;
  Window window;
  bool maximum = true;  // otherwise the average; then the window has no padding
  NumberFormat format = NumberFormat::kFloat32;
};

// Where the operands lie; the memory must outlive the step.
struct StepMemory {
  void* input = nullptr;
  void* addend = nullptr;
  void* output = nullptr;
};

// Prepare an operator: they choose and generate its code and bring the weights into the order it
// wants. They throw dnnl::error (a std::exception) when oneDNN has no implementation.
std::unique_ptr<Step> MakeConvolutionStep(const ConvolutionSpec& spec, const StepMemory& memory);
std::unique_ptr<Step> MakePoolStep(const PoolSpec& spec, const StepMemory& memory);

// The output format of a convolution that computes in `compute`: whether oneDNN can write `output`
// directly.
bool CanWrite(NumberFormat compute, NumberFormat output);

// What this processor computes fast.
bool HasBfloat16();      // AVX-512, where oneDNN makes do without BF16 instructions
bool HasFastBfloat16();  // AVX-512 BF16 or AMX
bool HasMatrixUnit();    // AMX

// 127 where the processor adds 8-bit products in 32 bits (VNNI, AMX); else 64, with which the sum
// of two products fits into the 16 bits that it has for them.
int LargestInt8Weight();

}  // namespace msf
