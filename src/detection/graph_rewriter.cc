#include "detection/graph_rewriter.h"

#include <algorithm>

namespace msf {

GraphRewriter::GraphRewriter(Graph& graph) : graph_(graph) { Index(); }

void GraphRewriter::Index() {
  producer_.assign(graph_.values.size(), -1);
  for (size_t i = 0; i < graph_.nodes.size(); ++i) {
    for (const ValueId output : graph_.nodes[i].outputs) {
      producer_[static_cast<size_t>(output)] = static_cast<int>(i);
    }
  }
  uses_ = graph_.CountUses();
}

std::vector<int> GraphRewriter::LiveNodes() const {
  std::vector<int> live;
  for (size_t i = 0; i < graph_.nodes.size(); ++i) {
    if (!graph_.nodes[i].op.empty()) live.push_back(static_cast<int>(i));
  }
  return live;
}

int GraphRewriter::OnlyFedBy(ValueId value, const std::string& op) const {
  if (value == kNoValue || Uses(value) != 1) return -1;
  const int index = Producer(value);
  return index >= 0 && graph_.nodes[static_cast<size_t>(index)].op == op ? index : -1;
}

void GraphRewriter::Add(Node node) {
  graph_.nodes.push_back(std::move(node));
  Index();
}

void GraphRewriter::Remove(int index) {
  graph_.nodes[static_cast<size_t>(index)] = Node();
  Index();
}

void GraphRewriter::ReplaceUses(ValueId from, ValueId to) {
  for (Node& node : graph_.nodes) {
    std::replace(node.inputs.begin(), node.inputs.end(), from, to);
    if (node.epilogue.addend == from) node.epilogue.addend = to;
  }
  std::replace(graph_.outputs.begin(), graph_.outputs.end(), from, to);
  Index();
}

void GraphRewriter::RedirectOutput(int index, ValueId to) {
  node(index).outputs[0] = to;
  Index();
}

void GraphRewriter::Sort() {
  Index();
  std::vector<Node> sorted;
  std::vector<bool> visited(graph_.nodes.size(), false);
  // Depth first from the outputs; an explicit stack, as a chain of nodes may be long.
  std::vector<int> stack;
  const auto push = [&](ValueId value) {
    const int producer = Producer(value);
    if (producer >= 0 && !visited[static_cast<size_t>(producer)]) stack.push_back(producer);
  };
  for (const ValueId output : graph_.outputs) {
    push(output);
    while (!stack.empty()) {
      const int index = stack.back();
      const size_t before = stack.size();
      if (!visited[static_cast<size_t>(index)]) {
        for (const ValueId read : node(index).Reads()) push(read);
      }
      if (stack.size() > before) continue;
      stack.pop_back();
      if (visited[static_cast<size_t>(index)]) continue;
      visited[static_cast<size_t>(index)] = true;
      sorted.push_back(node(index));
    }
  }
  graph_.nodes = std::move(sorted);
  Index();
}

}  // namespace msf
