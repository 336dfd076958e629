// The motion that brings one set of points onto another.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "geometry/rigid3d.h"

namespace msf {

// Scaled rigid motion, Sim(3): p -> scale * R * p + t.
struct Similarity3d {
  double scale = 1;
  Rigid3d motion;  // R and t

  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const {
    return motion.rotation() * (scale * point) + motion.translation();
  }
};

enum class ScaleEstimation { kFixed, kFree };

// The motion that minimises the sum of |to[i] - T * from[i]|^2 (Umeyama, PAMI 1991). Nothing for
// fewer than three points or when all of `from` coincide; points on one line leave the turn around
// it free, and some best motion is returned.
std::optional<Similarity3d> AlignPoints(std::span<const Eigen::Vector3d> from,
                                        std::span<const Eigen::Vector3d> to,
                                        ScaleEstimation scale = ScaleEstimation::kFixed);

}  // namespace msf
