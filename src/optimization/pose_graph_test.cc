#include "optimization/pose_graph.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace msf {
namespace {

double Error(const Rigid3d& a, const Rigid3d& b) {
  const Rigid3d difference = a * b.Inverse();
  return difference.translation().norm() + difference.Angle();
}

// A camera that looks outwards while it goes round a circle of 3 m radius.
std::vector<Rigid3d> Circle(int size) {
  std::vector<Rigid3d> T_cw;
  for (int i = 0; i < size; ++i) {
    const double angle = 2 * std::numbers::pi * i / size;
    const Eigen::Quaterniond q_wc = ExpRotation({0, 0, angle});
    T_cw.push_back(Rigid3d(q_wc, q_wc * Eigen::Vector3d(3, 0, 0)).Inverse());
  }
  return T_cw;
}

// Odometry with a constant error in each step, and one loop edge from the last to the first node.
PoseGraph DriftedCircle(const std::vector<Rigid3d>& truth, const Vector6d& drift) {
  PoseGraph graph;
  graph.nodes.push_back({truth[0], true});
  for (size_t i = 1; i < truth.size(); ++i) {
    const Rigid3d T_step = Rigid3d::Exp(drift) * truth[i] * truth[i - 1].Inverse();
    graph.nodes.push_back({T_step * graph.nodes.back().T_cw});
    graph.edges.push_back({static_cast<int>(i), static_cast<int>(i) - 1, T_step});
  }
  graph.edges.push_back({static_cast<int>(truth.size()) - 1, 0, truth.back() * truth[0].Inverse()});
  return graph;
}

double MeanError(const PoseGraph& graph, const std::vector<Rigid3d>& truth) {
  double sum = 0;
  for (size_t i = 0; i < truth.size(); ++i) sum += Error(graph.nodes[i].T_cw, truth[i]);
  return sum / truth.size();
}

Vector6d SmallDrift() {
  Vector6d drift;
  drift << 0.004, -0.003, 0.002, 0.0005, 0.001, 0.002;
  return drift;
}

TEST(PoseGraph, ClosingTheLoopTakesTheDriftOut) {
  const std::vector<Rigid3d> truth = Circle(100);
  PoseGraph graph = DriftedCircle(truth, SmallDrift());
  const double before = MeanError(graph, truth);
  ASSERT_GT(before, 0.2);
  const PoseGraphResult result = SolvePoseGraph(graph, {});
  EXPECT_TRUE(result.usable);
  EXPECT_LT(result.final_cost, 0.05 * result.initial_cost);
  EXPECT_LT(MeanError(graph, truth), 0.25 * before);
  EXPECT_LT(Error(graph.nodes.back().T_cw, truth.back()), 0.02);
  EXPECT_EQ(Error(graph.nodes[0].T_cw, truth[0]), Error(truth[0], truth[0]));
}

TEST(PoseGraph, ConsistentEdgesAreMetExactly) {
  const std::vector<Rigid3d> truth = Circle(40);
  PoseGraph graph = DriftedCircle(truth, Vector6d::Zero());
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (size_t i = 1; i < graph.nodes.size(); ++i) {
    Vector6d twist;
    for (double& value : twist) value = 0.2 * normal(random);
    graph.nodes[i].T_cw = Rigid3d::Exp(twist) * graph.nodes[i].T_cw;
  }
  PoseGraphOptions options;
  options.function_tolerance = 1e-14;
  ASSERT_TRUE(SolvePoseGraph(graph, options).usable);
  EXPECT_LT(MeanError(graph, truth), 1e-6);
}

TEST(PoseGraph, InformationDecidesWhoGivesWay) {
  // Two edges disagree about the same motion: 1 m with information 9, 2 m with information 1.
  PoseGraph graph;
  graph.nodes = {{Rigid3d(), true}, {Rigid3d()}};
  graph.edges.push_back(
      {1, 0, {Eigen::Quaterniond::Identity(), {1, 0, 0}}, 9 * Matrix6d::Identity()});
  graph.edges.push_back({1, 0, {Eigen::Quaterniond::Identity(), {2, 0, 0}}});
  ASSERT_TRUE(SolvePoseGraph(graph, {}).usable);
  EXPECT_NEAR(graph.nodes[1].T_cw.translation().x(), 1.1, 1e-3);
}

TEST(PoseGraph, KernelHoldsAgainstAWrongLoop) {
  const std::vector<Rigid3d> truth = Circle(60);
  PoseGraph graph = DriftedCircle(truth, Vector6d::Zero());
  graph.edges.push_back({30, 10, Rigid3d(Eigen::Quaterniond::Identity(), {0, 0, 1})});
  PoseGraph robust = graph;
  SolvePoseGraph(graph, {});
  PoseGraphOptions options;
  options.huber_width = 0.01;
  SolvePoseGraph(robust, options);
  EXPECT_LT(MeanError(robust, truth), 0.3 * MeanError(graph, truth));
}

TEST(PoseGraph, RepeatsBitForBit) {
  PoseGraph a = DriftedCircle(Circle(100), SmallDrift()), b = a;
  SolvePoseGraph(a, {});
  SolvePoseGraph(b, {});
  for (size_t i = 0; i < a.nodes.size(); ++i) {
    EXPECT_EQ(a.nodes[i].T_cw.translation(), b.nodes[i].T_cw.translation());
    EXPECT_EQ(a.nodes[i].T_cw.rotation().coeffs(), b.nodes[i].T_cw.rotation().coeffs());
  }
}

TEST(PoseGraph, SurvivesEmptyLonelyAndFixedNodes) {
  PoseGraph graph;
  SolvePoseGraph(graph, {});
  const Rigid3d pose(Eigen::Quaterniond::Identity(), {1, 2, 3});
  graph.nodes = {{pose, true}, {pose, true}, {pose}};
  graph.edges.push_back({1, 0, Rigid3d(Eigen::Quaterniond::Identity(), {5, 0, 0})});
  SolvePoseGraph(graph, {});
  for (const PoseGraphNode& node : graph.nodes)
    EXPECT_EQ(Error(node.T_cw, pose), Error(pose, pose));
  graph.edges.push_back({1, 3, pose});
  EXPECT_THROW(SolvePoseGraph(graph, {}), ContractViolation);
}

}  // namespace
}  // namespace msf
