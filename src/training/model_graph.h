// A detector as a plain list of primitive operations: what libtorch trains, what is counted, and
// what is exported, from one description that depends on none of them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace msf {

enum class GraphOp {
  kInput,
  kConv,
  kNorm,
  kMaxPool,
  kAveragePool,
  kUpsample,
  kConcat,
  kAdd,
  kSlice
};

// One operation. Its inputs are earlier nodes; its output has `channels` channels and 1/`scale` of
// the image's width and height.
struct GraphNode {
  GraphOp op = GraphOp::kInput;
  std::string name = {};  // prefix of its tensors, e.g. "model.2.cv1"; empty when it has none
  std::vector<int> inputs = {};
  int channels = 3;
  int scale = 1;
  int kernel = 1;           // convolutions and pools
  int stride = 1;           // convolutions and pools
  int groups = 1;           // convolutions
  bool normalized = false;  // convolutions: batch norm follows (and there is no bias)
  bool bias = false;        // convolutions without batch norm
  bool activated = false;   // SiLU at the end (convolutions and norms)
  int slice_begin = 0;      // kSlice: first channel taken
};

// A row of the layer table: the nodes [begin, end) of the graph.
struct GraphLayer {
  std::string type;
  int begin = 0;
  int end = 0;
};

struct ModelGraph {
  std::string name;
  std::vector<std::string> classes;
  std::vector<GraphNode> nodes;
  std::vector<GraphLayer> layers;
  // The outputs, one per scale: DFL logits of the four box sides [1, 4 * kBoxBins, h, w], class
  // logits [1, classes, h, w].
  std::vector<int> box_heads;
  std::vector<int> class_heads;

  // Node that layer `index` hands on.
  int LayerOutput(int index) const { return layers[index].end - 1; }
};

// Bins per box side in the distribution focal loss.
inline constexpr int kBoxBins = 16;

// Learnable parameters of one node or a whole graph, as the usual tools count a fused model: the
// batch norm of a plain convolution block counts as one bias per channel. Norms of MSFConv's
// branches and of its concatenation count in full.
int64_t CountParameters(const ModelGraph& graph, const GraphNode& node);
int64_t CountParameters(const ModelGraph& graph);

// Floating-point operations for an image of `width` x `height` pixels: 2 per multiply-add of a
// convolution and per element of a norm that CountParameters counts in full, sums and averages as
// they are; activations, maxima and copies are free.
int64_t CountFlops(const ModelGraph& graph, const GraphNode& node, int width, int height);
int64_t CountFlops(const ModelGraph& graph, int width, int height);

// Appends nodes to a graph; every method returns the index of the node it made.
class GraphBuilder {
 public:
  explicit GraphBuilder(ModelGraph& graph) : graph_(graph) {}

  // Starts a row of the layer table; the nodes until the next call belong to it.
  void BeginLayer(std::string type);
  void EndLayer();
  // Name of the layer begun last, the prefix of its tensors: "model.4".
  std::string LayerName() const { return "model." + std::to_string(graph_.layers.size() - 1); }

  int Input();
  // Convolution + batch norm + SiLU.
  int Conv(const std::string& name, int input, int channels, int kernel = 1, int stride = 1);
  // A convolution with any of the node's switches set by hand.
  int RawConv(GraphNode conv, int input);
  int Norm(const std::string& name, int input);
  int MaxPool(int input, int kernel, int stride);
  int AveragePool(int input, int kernel);
  int Upsample(int input);
  int Concat(const std::vector<int>& inputs);
  int Add(int a, int b);
  int Slice(int input, int begin, int channels);

  const GraphNode& node(int index) const { return graph_.nodes[index]; }

 private:
  int Append(GraphNode node);
  ModelGraph& graph_;
};

}  // namespace msf
