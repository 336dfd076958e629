#include "util/process_usage.h"

#include <gtest/gtest.h>

#include <vector>

namespace msf {
namespace {

TEST(ProcessUsage, MemoryAndTimeThatAreUsedShow) {
  const ProcessUsage before = ReadProcessUsage();
  EXPECT_GT(before.peak_memory_bytes, 1 << 20);
  constexpr int64_t kBytes = 64 << 20;
  {
    std::vector<char> block(kBytes, 1);
    volatile int64_t sum = 0;
    for (const char c : block) sum = sum + c;
    EXPECT_EQ(sum, kBytes);
  }
  const ProcessUsage after = ReadProcessUsage();
  EXPECT_GE(after.peak_memory_bytes, kBytes);
  EXPECT_GT(after.cpu_time_s, before.cpu_time_s);
}

}  // namespace
}  // namespace msf
