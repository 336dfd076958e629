// Large flat surfaces - walls, floors, tables - that go on outside of objects' boxes: what lies on
// one is not the object, however close the object comes to it.
#pragma once

#include "dynamic/block_rays.h"
#include "dynamic/dynamic_options.h"

namespace msf {

// Blocks on planes: 255, others 0. Those where `excluded` is 255 make none and must hang together
// with a part of their plane where it is not, and which is not much smaller: a box may hold
// something flat that moves, and be too small for it. Nor is a
// plane what lies for the most part where `in_mask` is 255, in what was an object a moment ago.
// Consensus over samples decided by `seed`.
cv::Mat1b FindPlaneBlocks(const CoarseDepth& depth, const BlockRays& rays,
                          const cv::Mat1b& excluded, const cv::Mat1b& in_mask,
                          const PlaneOptions& options, uint64_t seed);

}  // namespace msf
