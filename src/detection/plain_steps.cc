#include "detection/plain_steps.h"

namespace msf {
namespace {

class ConvertStep : public Step {
 public:
  ConvertStep(const Shape& shape, const void* from, const Storage& from_storage, void* to,
              const Storage& to_storage)
      : shape_(shape), from_(from), to_(to), from_storage_(from_storage), to_storage_(to_storage) {}

  Status Run() override {
    Convert(shape_, from_, from_storage_, to_, to_storage_);
    return Status::Ok();
  }

 private:
  const Shape shape_;
  const void* from_;
  void* to_;
  const Storage from_storage_, to_storage_;
};

class CopyChannelsStep : public Step {
 public:
  CopyChannelsStep(std::vector<ChannelCopy> copies, size_t pixels)
      : copies_(std::move(copies)), pixels_(pixels) {}

  Status Run() override {
    for (const ChannelCopy& c : copies_)
      CopyChannels(c.from, c.source, c.to, c.target, c.run_bytes, pixels_);
    return Status::Ok();
  }

 private:
  const std::vector<ChannelCopy> copies_;
  const size_t pixels_;
};

class RepeatStep : public Step {
 public:
  RepeatStep(const Shape& input, const Shape& output, size_t element_bytes, const void* from,
             void* to)
      : height_(static_cast<size_t>(input[2])),
        width_(static_cast<size_t>(input[3])),
        pixel_bytes_(static_cast<size_t>(input[1]) * element_bytes),
        factor_y_(static_cast<size_t>(output[2] / input[2])),
        factor_x_(static_cast<size_t>(output[3] / input[3])),
        from_(static_cast<const uint8_t*>(from)),
        to_(static_cast<uint8_t*>(to)) {}

  Status Run() override {
    RepeatPixels(from_, height_, width_, pixel_bytes_, factor_y_, factor_x_, to_);
    return Status::Ok();
  }

 private:
  const size_t height_, width_, pixel_bytes_, factor_y_, factor_x_;
  const uint8_t* from_;
  uint8_t* to_;
};

class ReferenceStep : public Step {
 public:
  explicit ReferenceStep(ComputeContext context)
      : context_(std::move(context)), compute_(FindOperator(context_.node.op)->compute) {}

  Status Run() override {
    const Status status = compute_(context_);
    return status.ok() ? status : Status::Error(Describe(context_.node) + " " + status.message());
  }

 private:
  const ComputeContext context_;
  Status (*compute_)(const ComputeContext&);
};

}  // namespace

std::unique_ptr<Step> MakeConvertStep(const Shape& shape, const void* from,
                                      const Storage& from_storage, void* to,
                                      const Storage& to_storage) {
  return std::make_unique<ConvertStep>(shape, from, from_storage, to, to_storage);
}

std::unique_ptr<Step> MakeCopyChannelsStep(std::vector<ChannelCopy> copies, size_t pixels) {
  return std::make_unique<CopyChannelsStep>(std::move(copies), pixels);
}

std::unique_ptr<Step> MakeRepeatStep(const Shape& input, const Shape& output, size_t element_bytes,
                                     const void* from, void* to) {
  return std::make_unique<RepeatStep>(input, output, element_bytes, from, to);
}

std::unique_ptr<Step> MakeReferenceStep(ComputeContext context) {
  return std::make_unique<ReferenceStep>(std::move(context));
}

}  // namespace msf
