// The geometry of operators that slide a window over an image: convolutions and pools.
#pragma once

#include "detection/operators.h"

namespace msf {

// One window operator on [N, C, H, W], all in pixels. Index 0 is vertical, 1 horizontal.
struct Window {
  int64_t kernel[2] = {1, 1};
  int64_t stride[2] = {1, 1};
  int64_t dilation[2] = {1, 1};
  int64_t pad_begin[2] = {0, 0};
  int64_t pad_end[2] = {0, 0};
  int64_t output[2] = {0, 0};  // size of the result
};

// Reads strides, pads, dilations, auto_pad and ceil_mode of a node whose input is [N, C, H, W].
StatusOr<Window> ReadWindow(const Node& node, const Shape& input, int64_t kernel_h,
                            int64_t kernel_w);

}  // namespace msf
