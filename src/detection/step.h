// One operation of a compiled network.
#pragma once

#include <cstddef>

#include "util/status.h"

namespace msf {

class Step {
 public:
  virtual ~Step() = default;
  // Reads its operands and writes its result; memory and kernels were fixed when it was made.
  virtual Status Run() = 0;
  // Working memory that it needs while it runs, shared by all steps.
  virtual size_t ScratchBytes() const { return 0; }
  virtual void SetScratch(void* /*scratch*/) {}
};

}  // namespace msf
