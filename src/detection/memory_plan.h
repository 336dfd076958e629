// Puts the buffers of a network into one block of memory, reusing the place of those that are no
// longer needed.
#pragma once

#include <cstddef>
#include <vector>

namespace msf {

// A buffer that is in use from step `first` to step `last`, both included.
struct BufferLife {
  size_t bytes = 0;
  int first = 0;
  int last = 0;
};

struct MemoryPlan {
  std::vector<size_t> offsets;  // per buffer, multiples of 64
  size_t total_bytes = 0;
};

// No two buffers that are in use at the same step overlap. Large buffers choose first, each takes
// the lowest place that fits.
MemoryPlan PlanMemory(const std::vector<BufferLife>& buffers);

}  // namespace msf
