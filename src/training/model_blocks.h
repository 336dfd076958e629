// The building blocks of the detectors. Each begins a layer, appends its nodes and returns the
// index of its output.
#pragma once

#include <array>
#include <vector>

#include "training/model_graph.h"

namespace msf {

// Convolution + batch norm + SiLU.
int ConvLayer(GraphBuilder& build, int input, int channels, int kernel, int stride);

struct MsfConvShape {
  double width = 0.5;                 // branch width over output width
  std::vector<int> kernels = {3, 5};  // of the depthwise separable branches
  int standard_kernel = 3;            // of the standard branch
};

// MSFConv with stride 2: SiLU(BN(Conv3x3 stride 2)) to the branch width, parallel branches
// (depthwise separable ones and a standard convolution, each with batch norm), plus the
// average-pooled input where widths agree, concatenation, batch norm, SiLU, Conv1x1.
int MsfConvLayer(GraphBuilder& build, int input, int channels, const MsfConvShape& shape);

// Two halves by 1x1, `repeats` bottlenecks of two 3x3 chained on the second, all pieces
// concatenated, 1x1.
int C2fLayer(GraphBuilder& build, int input, int channels, int repeats, bool shortcut);

// 1x1 to half, three chained 5x5 max-pools, all four concatenated, 1x1.
int SppfLayer(GraphBuilder& build, int input, int channels);

int UpsampleLayer(GraphBuilder& build, int input);
int ConcatLayer(GraphBuilder& build, const std::vector<int>& inputs);

// Maps at 1/8, 1/16 and 1/32 of the image.
using Pyramid = std::array<int, 3>;

// Feature pyramid (after Lin et al. 2017): every scale adds the coarser one, brought to its width
// by 1x1 and doubled in size; a 3x3 convolution smooths the sums.
Pyramid FpnNeck(GraphBuilder& build, const Pyramid& stages);

// High-resolution exchange (after HRNet, Sun et al. 2019): the three scales stay parallel; each
// unit runs residual pairs of 3x3 convolutions per scale (most of them at the coarse one, where
// they are cheap) and then adds every scale, brought to size and width, to every other.
Pyramid ExchangeNeck(GraphBuilder& build, const Pyramid& stages, int units);

}  // namespace msf
