#include "training/mixed_precision.h"

#include <ATen/autocast_mode.h>

namespace msf {

MixedPrecision::MixedPrecision(bool enabled) : enabled_(enabled) {
  if (!enabled_) return;
  at::autocast::set_autocast_cpu_dtype(at::kBFloat16);
  at::autocast::set_cpu_enabled(true);
}

MixedPrecision::~MixedPrecision() {
  if (!enabled_) return;
  at::autocast::set_cpu_enabled(false);
  // Weights change between two uses, so their converted copies must not outlive one.
  at::autocast::clear_cache();
}

}  // namespace msf
