// Steps that need no library: copying, converting and the plain implementations of operators.
#pragma once

#include <memory>
#include <vector>

#include "detection/operators.h"
#include "detection/step.h"
#include "detection/storage.h"

namespace msf {

// One piece of a concatenation or a slice.
struct ChannelCopy {
  const uint8_t* from = nullptr;
  ChannelRun source{};
  uint8_t* to = nullptr;
  ChannelRun target{};
  size_t run_bytes = 0;
};

std::unique_ptr<Step> MakeConvertStep(const Shape& shape, const void* from,
                                      const Storage& from_storage, void* to,
                                      const Storage& to_storage);
std::unique_ptr<Step> MakeCopyChannelsStep(std::vector<ChannelCopy> copies, size_t pixels);
std::unique_ptr<Step> MakeRepeatStep(const Shape& input, const Shape& output, size_t element_bytes,
                                     const void* from, void* to);
// `context` refers to its node, which must outlive the step.
std::unique_ptr<Step> MakeReferenceStep(ComputeContext context);

}  // namespace msf
