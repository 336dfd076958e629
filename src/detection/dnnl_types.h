// What the oneDNN steps share. Included by their source files only.
#pragma once

#include <dnnl.hpp>

#include "detection/storage.h"
#include "detection/window.h"

namespace msf {

// The one engine for the processor.
const dnnl::engine& CpuEngine();

dnnl::memory::data_type DataType(NumberFormat format);

// An image [1, C, H, W] that lies channels last.
dnnl::memory::desc ImageDesc(const Shape& shape, NumberFormat format);

// The padding behind the image with which oneDNN arrives at the window's output size (which
// ceil_mode may have enlarged).
dnnl::memory::dims PadEnd(const Window& window, const Shape& input);

}  // namespace msf
