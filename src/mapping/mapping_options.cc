#include "mapping/mapping_options.h"

namespace msf {

Status MappingOptions::Check() const {
  if (num_neighbours < 1 || num_second_neighbours < 0)
    return Status::Error("mapping: numbers of neighbours must be positive");
  if (max_bundle_keyframes < 2)
    return Status::Error("mapping.max_bundle_keyframes must be at least 2");
  if (!(redundant_share > 0 && redundant_share <= 1))
    return Status::Error("mapping.redundant_share must be in (0, 1]");
  if (!(min_static_probability >= 0 && min_static_probability < 1))
    return Status::Error("mapping.min_static_probability must be in [0, 1)");
  if (!(fuse_radius_px > 0)) return Status::Error("mapping.fuse_radius_px must be positive");
  if (!(close_depth_baselines > 0))
    return Status::Error("mapping.close_depth_baselines must be positive");
  return bundle.Check();
}

}  // namespace msf
