#include "detection/window.h"

namespace msf {
namespace {

constexpr int64_t kMaxWindow = 4096;

bool InRange(int64_t x, int64_t low) { return x >= low && x <= kMaxWindow; }

// SAME_UPPER and SAME_LOWER: the result has ceil(size / stride) pixels.
void PadToSame(Window& w, int d, int64_t size, bool lower) {
  const int64_t extent = (w.kernel[d] - 1) * w.dilation[d] + 1;
  const int64_t result = (size + w.stride[d] - 1) / w.stride[d];
  const int64_t pad = std::max<int64_t>((result - 1) * w.stride[d] + extent - size, 0);
  w.pad_begin[d] = lower ? pad - pad / 2 : pad / 2;
  w.pad_end[d] = pad - w.pad_begin[d];
}

}  // namespace

StatusOr<Window> ReadWindow(const Node& node, const Shape& input, int64_t kernel_h,
                            int64_t kernel_w) {
  if (input.size() != 4) return Status::Error("works on images only, not on " + ToString(input));
  const std::vector<int64_t> strides = node.Ints("strides", {1, 1});
  const std::vector<int64_t> dilations = node.Ints("dilations", {1, 1});
  const std::vector<int64_t> pads = node.Ints("pads", {0, 0, 0, 0});
  if (strides.size() != 2 || dilations.size() != 2 || pads.size() != 4) {
    return Status::Error("has strides, dilations or pads that do not fit an image");
  }
  const std::string auto_pad = node.String("auto_pad", "NOTSET");
  const bool ceil_mode = node.Int("ceil_mode", 0) != 0;
  Window w;
  for (int d = 0; d < 2; ++d) {
    const size_t i = static_cast<size_t>(d);
    const int64_t size = input[i + 2];
    w.kernel[d] = d == 0 ? kernel_h : kernel_w;
    w.stride[d] = strides[i];
    w.dilation[d] = dilations[i];
    w.pad_begin[d] = pads[i];
    w.pad_end[d] = pads[i + 2];
    if (!InRange(w.kernel[d], 1) || !InRange(w.stride[d], 1) || !InRange(w.dilation[d], 1) ||
        !InRange(w.pad_begin[d], 0) || !InRange(w.pad_end[d], 0)) {
      return Status::Error("has a bad kernel, stride, dilation or padding");
    }
    if (auto_pad == "VALID") w.pad_begin[d] = w.pad_end[d] = 0;
    if (auto_pad == "SAME_UPPER" || auto_pad == "SAME_LOWER") {
      PadToSame(w, d, size, auto_pad == "SAME_LOWER");
    }
    const int64_t extent = (w.kernel[d] - 1) * w.dilation[d] + 1;
    const int64_t room = size + w.pad_begin[d] + w.pad_end[d] - extent;
    if (room < 0) return Status::Error("has a kernel larger than its input " + ToString(input));
    w.output[d] = (room + (ceil_mode ? w.stride[d] - 1 : 0)) / w.stride[d] + 1;
    // A window that would start in the trailing padding is left out.
    if (ceil_mode && (w.output[d] - 1) * w.stride[d] >= size + w.pad_begin[d]) --w.output[d];
  }
  return w;
}

}  // namespace msf
