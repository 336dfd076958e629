// Starting weights of MSFConv blocks in closed form.
#pragma once

#include <map>

#include "training/network.h"

namespace msf {

// Gives every MSFConv layer of `student` weights with which it reproduces the teacher's convolution
// in its place as well as linear algebra can say, from the pictures `images` [batch, 3, h, w]:
//  - the stride-2 convolution computes the principal components of the teacher's pre-activations
//  (weighted by how much each
//    matters after SiLU), shifted to where SiLU is nearly linear;
//  - each branch restores its share of the pre-activations from them by least squares, the residual
//  taken into account;
//  - the last 1x1 is the least-squares map from the activated branches to the teacher's output.
// A block whose branches are as wide as its output, and wider than its input, takes the teacher's
// convolution over as it is: two branches hand it on with opposite signs, since SiLU(y) - SiLU(-y)
// = y. (A larger network that begins as the smaller one's equal: Chen et al., "Net2Net", ICLR
// 2016.) Layers are treated one after the other, each on what the student itself computes before
// it, so that later ones make up for earlier errors. Both networks' layers correspond one to one;
// the student's other layers hold the teacher's weights. Returns the relative squared error of the
// output of each MSFConv layer, by its index (1: as bad as the mean).
std::map<int, double> InitializeMsfLayers(Network& student, const Network& teacher,
                                          const torch::Tensor& images);

}  // namespace msf
