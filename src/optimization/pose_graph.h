// Poses from relative poses: spreads the error that a closed loop reveals over the whole
// trajectory.
#pragma once

#include <string>
#include <vector>

#include "geometry/rigid3d.h"
#include "util/status.h"

namespace msf {

struct PoseGraphNode {
  Rigid3d T_cw;
  bool fixed = false;
};

// The measured motion between two nodes (indices), T_ab = T_aw * T_bw^-1, and how much to trust it:
// inverse covariance of the error (translation in m, rotation in rad, in frame b).
struct PoseGraphEdge {
  int a = -1;
  int b = -1;
  Rigid3d T_ab;
  Matrix6d information = Matrix6d::Identity();
};

struct PoseGraph {
  std::vector<PoseGraphNode> nodes;
  std::vector<PoseGraphEdge> edges;
};

struct PoseGraphOptions {
  int max_iterations = 30;
  double function_tolerance = 1e-6;
  double huber_width = 0;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("max_iterations", max_iterations, "Levenberg-Marquardt iterations");
    visit("function_tolerance", function_tolerance,
          "ends when a step lowers the cost by less than this part of it");
    visit("huber_width", huber_width,
          "edges with a larger normalised error pull less (Huber's kernel); 0: no kernel");
  }
  Status Check() const;
};

struct PoseGraphResult {
  bool usable = false;
  double initial_cost = 0;
  double final_cost = 0;
  int iterations = 0;
  std::string summary;  // one line for the log
};

// Minimises the sum over the edges of e^T information e, e = error of T_ab_measured^-1 * T_aw *
// T_bw^-1 (translation, 2 * vector part of the quaternion), over the nodes that are not fixed, in
// place. Single-threaded and deterministic.
PoseGraphResult SolvePoseGraph(PoseGraph& graph, const PoseGraphOptions& options);

}  // namespace msf
