// A network as a list of operators between values: what the ONNX reader makes and the executor
// compiles.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "detection/tensor.h"
#include "util/status.h"

namespace msf {

// Index into Graph::values.
using ValueId = int;
inline constexpr ValueId kNoValue = -1;

using Attribute =
    std::variant<int64_t, float, std::string, std::vector<int64_t>, std::vector<float>, Tensor>;

enum class Activation { kNone, kSilu, kRelu, kLeakyRelu, kSigmoid };

// What a convolution does with its sum before it writes, in this order:
//   y = x * w + b;  y += addend (if add_first);  y = y * scale + shift;  y = activation(y);
//   y += addend (if not add_first)
struct Epilogue {
  ValueId addend = kNoValue;  // same shape as the output
  bool add_first = false;
  std::vector<float> scale;  // per output channel, empty = 1
  std::vector<float> shift;  // per output channel, empty = 0
  Activation activation = Activation::kNone;
  float alpha = 0;  // slope of LeakyRelu for negative values
};

struct Node {
  std::string op;    // ONNX name, or one of ours: "Silu", "ChannelAffine" (x, scale[C], shift[C])
  std::string name;  // for messages
  std::vector<ValueId> inputs;  // kNoValue: an optional input that was left out
  std::vector<ValueId> outputs;
  std::map<std::string, Attribute> attributes;
  Epilogue epilogue;  // op "Conv" only

  // The attribute, or `otherwise` when it is absent or of another type.
  int64_t Int(const std::string& key, int64_t otherwise) const;
  float Float(const std::string& key, float otherwise) const;
  std::string String(const std::string& key, const std::string& otherwise) const;
  std::vector<int64_t> Ints(const std::string& key, std::vector<int64_t> otherwise = {}) const;
  bool Has(const std::string& key) const { return attributes.count(key) > 0; }
  // Inputs and the epilogue's addend, without the absent ones.
  std::vector<ValueId> Reads() const;
};

struct Value {
  std::string name;
  ElementType type = ElementType::kFloat;
  bool shape_known = false;
  Shape shape;
  std::shared_ptr<const Tensor> constant;  // none: computed at run time
};

struct Graph {
  std::string source;  // the file, for messages
  int64_t opset = 13;
  std::vector<Value> values;
  std::vector<Node> nodes;      // every value is written before it is read
  std::vector<ValueId> inputs;  // images [1, 3, H, W], RGB in 0..1
  std::vector<ValueId> outputs;
  std::map<std::string, std::string> metadata;

  ValueId AddValue(std::string name);
  ValueId AddConstant(std::string name, Tensor tensor);
  Value& value(ValueId id) { return values[static_cast<size_t>(id)]; }
  const Value& value(ValueId id) const { return values[static_cast<size_t>(id)]; }
  bool IsConstant(ValueId id) const { return id != kNoValue && value(id).constant != nullptr; }
  // How often nodes and graph outputs read each value.
  std::vector<int> CountUses() const;
};

// The name of a node for messages: "node 'model.0/conv' (Conv)".
std::string Describe(const Node& node);

}  // namespace msf
