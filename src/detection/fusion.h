// Simplifies a specialised graph before it is compiled: fewer, larger operators that compute the
// same.
#pragma once

#include "detection/graph.h"

namespace msf {

// In this order: drops operators without effect; x * sigmoid(x) becomes Silu; batch normalisation
// becomes ChannelAffine; affine maps and activations move through concatenations towards the
// convolutions that feed them; convolutions take up the affine maps, additions and activations
// behind them; what nobody reads is removed. The names of the values that remain do not change.
// Results differ from the original only by rounding.
void Fuse(Graph& graph);

}  // namespace msf
