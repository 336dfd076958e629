#include "detection/graph.h"

namespace msf {
namespace {

template <typename T>
T Get(const Node& node, const std::string& key, T otherwise) {
  const auto found = node.attributes.find(key);
  if (found == node.attributes.end()) return otherwise;
  const T* value = std::get_if<T>(&found->second);
  return value ? *value : otherwise;
}

}  // namespace

int64_t Node::Int(const std::string& key, int64_t otherwise) const {
  return Get<int64_t>(*this, key, otherwise);
}

float Node::Float(const std::string& key, float otherwise) const {
  return Get<float>(*this, key, otherwise);
}

std::string Node::String(const std::string& key, const std::string& otherwise) const {
  return Get<std::string>(*this, key, otherwise);
}

std::vector<int64_t> Node::Ints(const std::string& key, std::vector<int64_t> otherwise) const {
  return Get<std::vector<int64_t>>(*this, key, std::move(otherwise));
}

std::vector<ValueId> Node::Reads() const {
  std::vector<ValueId> reads;
  for (const ValueId input : inputs) {
    if (input != kNoValue) reads.push_back(input);
  }
  if (epilogue.addend != kNoValue) reads.push_back(epilogue.addend);
  return reads;
}

ValueId Graph::AddValue(std::string name) {
  values.emplace_back();
  values.back().name = std::move(name);
  return static_cast<ValueId>(values.size()) - 1;
}

ValueId Graph::AddConstant(std::string name, Tensor tensor) {
  const ValueId id = AddValue(std::move(name));
  value(id).type = tensor.type;
  value(id).shape_known = true;
  value(id).shape = tensor.shape;
  value(id).constant = std::make_shared<const Tensor>(std::move(tensor));
  return id;
}

std::vector<int> Graph::CountUses() const {
  std::vector<int> uses(values.size(), 0);
  for (const Node& node : nodes) {
    for (const ValueId read : node.Reads()) ++uses[static_cast<size_t>(read)];
  }
  for (const ValueId output : outputs) ++uses[static_cast<size_t>(output)];
  return uses;
}

std::string Describe(const Node& node) { return "node '" + node.name + "' (" + node.op + ")"; }

}  // namespace msf
