// Coloured point clouds as PLY files (Turk 1994), binary little-endian: what MeshLab, CloudCompare
// and Open3D read.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "util/status.h"

namespace msf {

struct PlyPoint {
  Eigen::Vector3f p_w = Eigen::Vector3f::Zero();  // m
  std::array<uint8_t, 3> rgb{};
};

// Writes the points atomically; no points give a valid empty cloud.
Status WritePly(const std::filesystem::path& file, const std::vector<PlyPoint>& points);

}  // namespace msf
