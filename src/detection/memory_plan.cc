#include "detection/memory_plan.h"

#include <algorithm>
#include <numeric>

namespace msf {
namespace {

constexpr size_t kAlignment = 64;  // a cache line, the widest vector

bool Overlap(const BufferLife& a, const BufferLife& b) {
  return a.first <= b.last && b.first <= a.last;
}

size_t RoundUp(size_t bytes) { return (bytes + kAlignment - 1) / kAlignment * kAlignment; }

}  // namespace

MemoryPlan PlanMemory(const std::vector<BufferLife>& buffers) {
  std::vector<size_t> by_size(buffers.size());
  std::iota(by_size.begin(), by_size.end(), size_t{0});
  std::stable_sort(by_size.begin(), by_size.end(),
                   [&](size_t a, size_t b) { return buffers[a].bytes > buffers[b].bytes; });
  MemoryPlan plan;
  plan.offsets.assign(buffers.size(), 0);
  std::vector<size_t> placed;  // ordered by offset
  for (const size_t i : by_size) {
    size_t offset = 0;
    for (const size_t other : placed) {
      if (!Overlap(buffers[i], buffers[other])) continue;
      if (offset + buffers[i].bytes <= plan.offsets[other]) break;
      offset = std::max(offset, RoundUp(plan.offsets[other] + buffers[other].bytes));
    }
    plan.offsets[i] = offset;
    plan.total_bytes = std::max(plan.total_bytes, RoundUp(offset + buffers[i].bytes));
    const auto after = [&](size_t at, size_t other) { return at < plan.offsets[other]; };
    placed.insert(std::upper_bound(placed.begin(), placed.end(), offset, after), i);
  }
  return plan;
}

}  // namespace msf
