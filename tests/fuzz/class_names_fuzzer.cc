// libFuzzer target: the texts in a model's metadata.
#include <cstdint>
#include <string>

#include "detection/class_names.h"
#include "detection/compiled_network.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  (void)msf::ParseClassNames(text).ok();
  (void)msf::ParseActivationRanges(text).ok();
  return 0;
}
