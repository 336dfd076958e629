// libFuzzer target: whatever the bytes, reading an annotation ends with objects inside the image or
// a sentence.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "io/voc_dataset.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const auto image = msf::ParseVocAnnotation(std::string(reinterpret_cast<const char*>(data), size),
                                             "fuzz.xml", {"person", "dog"});
  if (!image.ok()) return 0;
  for (const msf::VocObject& o : image->objects) {
    const bool inside = o.x0 >= 0 && o.y0 >= 0 && o.x0 < o.x1 && o.y0 < o.y1 &&
                        o.x1 <= static_cast<float>(image->width) &&
                        o.y1 <= static_cast<float>(image->height);
    if (!inside) std::abort();
  }
  return 0;
}
