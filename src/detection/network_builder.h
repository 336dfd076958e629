// Turns a fused graph into the steps and memory of a CompiledNetwork.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "detection/compiled_network.h"
#include "detection/memory_plan.h"

namespace msf {

// First lists the steps with the buffers they use, then lays out memory, then makes the steps.
class NetworkBuilder {
 public:
  NetworkBuilder(CompiledNetwork& network, const CompileOptions& options, StoragePlan plan);
  Status Build();

 private:
  // Index into buffers_.
  using BufferId = int;
  // A value that lies in a buffer in one storage; it may lie elsewhere in another.
  struct Copy {
    Storage storage;
    BufferId buffer = -1;
  };
  struct PlannedStep {
    std::string what;  // for messages
    std::function<std::unique_ptr<Step>()> make;
  };

  const Value& value(ValueId id) const { return graph_.value(id); }
  const Storage& storage(ValueId id) const { return plan_.storage[static_cast<size_t>(id)]; }
  void* Address(BufferId buffer) const;

  // A buffer that the next step fills.
  BufferId NewBuffer(size_t bytes);
  // The value in the wanted storage for the next step to read; appends a conversion when it lies in
  // another one only.
  BufferId Read(ValueId id, const Storage& wanted);
  // Its memory is not reused before the next step is done.
  void KeepForNextStep(BufferId buffer);
  // The place where the next step puts the value.
  BufferId Write(ValueId id, const Storage& as);
  void Append(std::string what, std::function<std::unique_ptr<Step>()> make);

  void AddNode(size_t index);
  void AddConvolution(const Node& node, NumberFormat compute);
  // Into the network's totals.
  void CountConvolution(const Node& node, bool int8);
  void AddPool(const Node& node);
  void AddConcat(const Node& node);
  void AddSliceChannels(const Node& node);
  void AddRepeat(const Node& node);
  void AddPlain(const Node& node, bool channels_last);
  void AddOutputs();
  Status MakeSteps();
  void ShareScratch();
  void NameInnerValues();

  CompiledNetwork& network_;
  const Graph& graph_;
  const bool keep_values_;
  const StoragePlan plan_;
  std::vector<BufferLife> buffers_;
  std::map<ValueId, std::vector<Copy>> copies_;
  std::vector<PlannedStep> planned_;
  std::vector<BufferId> output_buffers_;
  MemoryPlan memory_;
};

}  // namespace msf
