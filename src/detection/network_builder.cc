#include "detection/network_builder.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <new>

#include "detection/dnnl_steps.h"
#include "detection/plain_steps.h"
#include "util/check.h"

namespace msf {
namespace {

// Zeroed memory on a cache line.
void* Allocate(size_t bytes) {
  const size_t rounded = std::max<size_t>((bytes + 63) / 64 * 64, 64);
  void* memory = std::aligned_alloc(64, rounded);
  if (!memory) throw std::bad_alloc();
  std::memset(memory, 0, rounded);
  return memory;
}

std::span<float> Floats(void* memory, const Shape& shape) {
  return {static_cast<float*>(memory), static_cast<size_t>(NumElements(shape))};
}

}  // namespace

NetworkBuilder::NetworkBuilder(CompiledNetwork& network, const CompileOptions& options,
                               StoragePlan plan)
    : network_(network),
      graph_(network.graph_),
      keep_values_(options.keep_values),
      plan_(std::move(plan)) {}

Status NetworkBuilder::Build() {
  const ValueId input = graph_.inputs[0];
  Write(input, storage(input));
  for (size_t i = 0; i < graph_.nodes.size(); ++i) AddNode(i);
  AddOutputs();
  if (keep_values_) {
    for (BufferLife& life : buffers_) life = {life.bytes, 0, static_cast<int>(planned_.size())};
  }
  memory_ = PlanMemory(buffers_);
  network_.activations_.reset(Allocate(memory_.total_bytes));
  network_.activation_bytes_ = memory_.total_bytes;
  network_.input_ = Address(copies_.at(input).front().buffer);
  for (size_t i = 0; i < output_buffers_.size(); ++i) {
    network_.outputs_[i].data = static_cast<const float*>(Address(output_buffers_[i]));
  }
  if (Status status = MakeSteps(); !status.ok()) return status;
  ShareScratch();
  NameInnerValues();
  return Status::Ok();
}

void* NetworkBuilder::Address(BufferId buffer) const {
  if (buffer < 0) return nullptr;
  return static_cast<std::byte*>(network_.activations_.get()) +
         memory_.offsets[static_cast<size_t>(buffer)];
}

NetworkBuilder::BufferId NetworkBuilder::NewBuffer(size_t bytes) {
  const int now = static_cast<int>(planned_.size());
  buffers_.push_back({bytes, now, now});
  return static_cast<BufferId>(buffers_.size()) - 1;
}

NetworkBuilder::BufferId NetworkBuilder::Read(ValueId id, const Storage& wanted) {
  std::vector<Copy>& copies = copies_.at(id);
  auto found = std::find_if(copies.begin(), copies.end(),
                            [&](const Copy& c) { return c.storage == wanted; });
  if (found == copies.end()) {
    const Copy from = copies.front();
    const Shape& shape = value(id).shape;
    const BufferId to = NewBuffer(NumBytes(shape, wanted));
    KeepForNextStep(from.buffer);
    Append("conversion of '" + value(id).name + "'", [this, shape, from, to, wanted] {
      return MakeConvertStep(shape, Address(from.buffer), from.storage, Address(to), wanted);
    });
    copies.push_back({wanted, to});
    found = copies.end() - 1;
  }
  KeepForNextStep(found->buffer);
  return found->buffer;
}

void NetworkBuilder::KeepForNextStep(BufferId buffer) {
  if (buffer < 0) return;
  BufferLife& life = buffers_[static_cast<size_t>(buffer)];
  life.last = std::max(life.last, static_cast<int>(planned_.size()));
}

NetworkBuilder::BufferId NetworkBuilder::Write(ValueId id, const Storage& as) {
  const BufferId buffer = NewBuffer(NumBytes(value(id).shape, as));
  copies_[id].push_back({as, buffer});
  return buffer;
}

void NetworkBuilder::Append(std::string what, std::function<std::unique_ptr<Step>()> make) {
  planned_.push_back({std::move(what), std::move(make)});
}

void NetworkBuilder::AddNode(size_t index) {
  const Node& node = graph_.nodes[index];
  switch (plan_.kinds[index]) {
    case NodeKind::kConvolution:
      return AddConvolution(node, plan_.compute[index]);
    case NodeKind::kPool:
      return AddPool(node);
    case NodeKind::kConcat:
      return AddConcat(node);
    case NodeKind::kSliceChannels:
      return AddSliceChannels(node);
    case NodeKind::kRepeat:
      return AddRepeat(node);
    case NodeKind::kElementwise:
      return AddPlain(node, true);
    case NodeKind::kReference:
      return AddPlain(node, false);
  }
}

void NetworkBuilder::CountConvolution(const Node& node, bool int8) {
  const Shape& weights = value(node.inputs[1]).constant->shape;
  const int64_t products_per_number = NumElements(weights) / weights[0];
  const auto products =
      static_cast<double>(NumElements(value(node.outputs[0]).shape) * products_per_number);
  ++network_.num_convolutions_;
  network_.num_products_ += products;
  if (!int8) return;
  ++network_.num_int8_convolutions_;
  network_.num_int8_products_ += products;
}

void NetworkBuilder::AddConvolution(const Node& node, NumberFormat compute) {
  const bool int8 = compute == NumberFormat::kUint8;
  CountConvolution(node, int8);
  ConvolutionSpec spec;
  spec.input_shape = value(node.inputs[0]).shape;
  spec.output_shape = value(node.outputs[0]).shape;
  spec.weights = value(node.inputs[1]).constant.get();
  if (node.inputs.size() > 2 && node.inputs[2] != kNoValue)
    spec.bias = value(node.inputs[2]).constant.get();
  const StatusOr<Window> window =
      ReadWindow(node, spec.input_shape, spec.weights->shape[2], spec.weights->shape[3]);
  spec.window = window.value();
  spec.group = node.Int("group", 1);
  spec.epilogue = node.epilogue;
  spec.compute = compute;
  spec.input = int8 ? storage(node.inputs[0]) : Storage{compute, true};
  const BufferId in = Read(node.inputs[0], spec.input);
  BufferId addend = -1;
  if (const ValueId id = node.epilogue.addend; id != kNoValue) {
    // Not 8 bits: oneDNN 2.6 adds those wrongly.
    spec.addend = storage(id);
    if (spec.addend.format == NumberFormat::kUint8) {
      spec.addend = {HasFastBfloat16() ? NumberFormat::kBfloat16 : NumberFormat::kFloat32};
    }
    spec.addend.channels_last = true;
    addend = Read(id, spec.addend);
  }
  // Where oneDNN cannot write the storage of the value, it writes its own format; readers convert
  // from there.
  spec.output = storage(node.outputs[0]);
  if (!CanWrite(compute, spec.output.format)) spec.output = {compute, true};
  const BufferId out = Write(node.outputs[0], spec.output);
  // The conversion may have appended steps after `in` was read: all operands live until this step.
  KeepForNextStep(in);
  KeepForNextStep(addend);
  Append(Describe(node), [this, spec, in, addend, out] {
    return MakeConvolutionStep(spec, {Address(in), Address(addend), Address(out)});
  });
}

void NetworkBuilder::AddPool(const Node& node) {
  PoolSpec spec;
  spec.input_shape = value(node.inputs[0]).shape;
  spec.output_shape = value(node.outputs[0]).shape;
  const std::vector<int64_t> kernel = node.Ints("kernel_shape");
  spec.window = ReadWindow(node, spec.input_shape, kernel[0], kernel[1]).value();
  spec.maximum = node.op == "MaxPool";
  const Storage as = storage(node.outputs[0]);
  spec.format = as.format;
  const BufferId in = Read(node.inputs[0], as);
  const BufferId out = Write(node.outputs[0], as);
  Append(Describe(node), [this, spec, in, out] {
    return MakePoolStep(spec, {Address(in), nullptr, Address(out)});
  });
}

void NetworkBuilder::AddConcat(const Node& node) {
  const Storage as = storage(node.outputs[0]);
  const size_t element = BytesPerElement(as.format);
  const Shape& shape = value(node.outputs[0]).shape;
  std::vector<std::pair<BufferId, ChannelCopy>> pieces;
  size_t first = 0;
  for (const ValueId id : node.inputs) {
    ChannelCopy copy;
    copy.run_bytes = static_cast<size_t>(value(id).shape[1]) * element;
    copy.source = {copy.run_bytes, 0};
    copy.target = {static_cast<size_t>(shape[1]) * element, first};
    first += copy.run_bytes;
    pieces.emplace_back(Read(id, as), copy);
  }
  for (const auto& piece : pieces) KeepForNextStep(piece.first);
  const BufferId out = Write(node.outputs[0], as);
  Append(Describe(node), [this, pieces, out, shape] {
    std::vector<ChannelCopy> copies;
    for (const auto& [buffer, copy] : pieces) {
      copies.push_back(copy);
      copies.back().from = static_cast<const uint8_t*>(Address(buffer));
      copies.back().to = static_cast<uint8_t*>(Address(out));
    }
    return MakeCopyChannelsStep(copies, static_cast<size_t>(shape[2] * shape[3]));
  });
}

void NetworkBuilder::AddSliceChannels(const Node& node) {
  const Storage as = storage(node.outputs[0]);
  const size_t element = BytesPerElement(as.format);
  const Shape& from = value(node.inputs[0]).shape;
  ChannelCopy copy;
  copy.run_bytes = static_cast<size_t>(node.Int("count", 0)) * element;
  copy.source = {static_cast<size_t>(from[1]) * element,
                 static_cast<size_t>(node.Int("first", 0)) * element};
  copy.target = {copy.run_bytes, 0};
  const BufferId in = Read(node.inputs[0], as);
  const BufferId out = Write(node.outputs[0], as);
  const size_t pixels = static_cast<size_t>(from[2] * from[3]);
  Append(Describe(node), [this, copy, in, out, pixels] {
    ChannelCopy placed = copy;
    placed.from = static_cast<const uint8_t*>(Address(in));
    placed.to = static_cast<uint8_t*>(Address(out));
    return MakeCopyChannelsStep({placed}, pixels);
  });
}

void NetworkBuilder::AddRepeat(const Node& node) {
  const Storage as = storage(node.outputs[0]);
  const Shape from = value(node.inputs[0]).shape, to = value(node.outputs[0]).shape;
  const BufferId in = Read(node.inputs[0], as);
  const BufferId out = Write(node.outputs[0], as);
  Append(Describe(node), [this, from, to, as, in, out] {
    return MakeRepeatStep(from, to, BytesPerElement(as.format), Address(in), Address(out));
  });
}

void NetworkBuilder::AddPlain(const Node& node, bool channels_last) {
  const Storage as{NumberFormat::kFloat32, channels_last};
  std::vector<BufferId> operands;
  std::vector<ValueId> reads = node.inputs;
  if (node.epilogue.addend != kNoValue) reads.push_back(node.epilogue.addend);
  operands.reserve(reads.size());
  for (const ValueId id : reads) {
    operands.push_back(id == kNoValue || graph_.IsConstant(id) ? -1 : Read(id, as));
  }
  for (const BufferId operand : operands) KeepForNextStep(operand);
  std::vector<BufferId> results;
  for (const ValueId id : node.outputs) results.push_back(Write(id, as));
  Append(Describe(node), [this, &node, reads, operands, results] {
    ComputeContext context{node, graph_.opset, {}, {}};
    for (size_t i = 0; i < reads.size(); ++i) {
      context.inputs.emplace_back();
      if (reads[i] == kNoValue) continue;
      InputView& view = context.inputs.back();
      const Value& operand = value(reads[i]);
      if (operand.constant) {
        view = InputView(*operand.constant);
      } else {
        view.present = true;
        view.shape = operand.shape;
        view.floats = Floats(Address(operands[i]), operand.shape);
      }
    }
    for (size_t i = 0; i < results.size(); ++i) {
      context.outputs.emplace_back();
      context.outputs.back().shape = value(node.outputs[i]).shape;
      context.outputs.back().floats = Floats(Address(results[i]), value(node.outputs[i]).shape);
    }
    return MakeReferenceStep(std::move(context));
  });
}

void NetworkBuilder::AddOutputs() {
  for (const ValueId id : graph_.outputs) {
    NetworkOutput output;
    output.name = value(id).name;
    output.shape = value(id).shape;
    output.channels_last = storage(id).channels_last;
    output_buffers_.push_back(Read(id, {NumberFormat::kFloat32, output.channels_last}));
    network_.outputs_.push_back(output);
  }
  // Results stay until the next run.
  for (const BufferId buffer : output_buffers_) KeepForNextStep(buffer);
}

Status NetworkBuilder::MakeSteps() {
  for (const PlannedStep& planned : planned_) {
    try {
      network_.steps_.push_back(planned.make());
    } catch (const std::exception& error) {  // dnnl::error, which this file does not know
      return Status::Error(graph_.source + ": " + planned.what +
                           " cannot be prepared: " + error.what());
    }
  }
  return Status::Ok();
}

void NetworkBuilder::ShareScratch() {
  size_t bytes = 0;
  for (const auto& step : network_.steps_) bytes = std::max(bytes, step->ScratchBytes());
  network_.scratch_.reset(Allocate(bytes));
  network_.activation_bytes_ += bytes;
  for (const auto& step : network_.steps_) step->SetScratch(network_.scratch_.get());
}

void NetworkBuilder::NameInnerValues() {
  for (const Node& node : graph_.nodes) {
    for (const ValueId id : node.outputs) {
      const Copy& copy = copies_.at(id).front();
      if (copy.storage.format != NumberFormat::kFloat32 || value(id).shape.size() != 4) continue;
      network_.inner_values_.push_back({value(id).name, value(id).shape, copy.storage.channels_last,
                                        static_cast<const float*>(Address(copy.buffer))});
    }
  }
}

}  // namespace msf
