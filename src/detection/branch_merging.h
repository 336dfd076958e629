// Replaces parallel linear branches by one dense convolution.
#pragma once

#include "detection/graph.h"

namespace msf {

// A depthwise convolution followed, without a nonlinearity, by a 1x1 convolution becomes one dense
// convolution; convolutions of one input whose results are concatenated become one convolution with
// the largest of their kernels. So the branches of an MSFConv block become a single convolution. It
// multiplies more but does so in large dense products: a gain where matrix units make those cheap
// (Intel AMX), a loss elsewhere. Call after Fuse().
void MergeBranches(Graph& graph);

}  // namespace msf
