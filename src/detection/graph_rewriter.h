// Editing a graph: who makes a value, who reads it, replacing and removing nodes.
#pragma once

#include "detection/graph.h"

namespace msf {

class GraphRewriter {
 public:
  explicit GraphRewriter(Graph& graph);

  Graph& graph() { return graph_; }
  // Indices of living nodes, in the order in which they can run. Stable while nodes are removed,
  // not when they are added.
  std::vector<int> LiveNodes() const;
  Node& node(int index) { return graph_.nodes[static_cast<size_t>(index)]; }

  // The node that makes a value; -1 for inputs and constants.
  int Producer(ValueId value) const { return producer_[static_cast<size_t>(value)]; }
  // Readers of a value, the graph's outputs included.
  int Uses(ValueId value) const { return uses_[static_cast<size_t>(value)]; }
  // The producer when it has operator `op` and this value is read exactly once; -1 otherwise.
  int OnlyFedBy(ValueId value, const std::string& op) const;

  // Adds a node behind the existing ones; Sort() brings it into place.
  void Add(Node node);
  void Remove(int index);
  // Everything that reads `from` reads `to`; a graph output keeps its name.
  void ReplaceUses(ValueId from, ValueId to);
  // Makes `node` write `to` instead of its first output; the former maker of `to` must be removed
  // before.
  void RedirectOutput(int index, ValueId to);

  // Drops removed nodes and those that nobody reads, and orders the rest so that values are written
  // before they are read.
  void Sort();

 private:
  void Index();
  Graph& graph_;
  std::vector<int> producer_;
  std::vector<int> uses_;
};

}  // namespace msf
