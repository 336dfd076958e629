#include "detection/onnx_tensor.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "detection/operators.h"

namespace msf {
namespace {

using Proto = onnx::TensorProto;

template <typename T>
T At(const std::string& raw, size_t i) {
  T value;
  std::memcpy(&value, raw.data() + i * sizeof(T), sizeof(T));
  return value;
}

// Fills `out` from raw bytes, or from a typed field when there are none.
template <typename Raw, typename Out, typename Field, typename Convert>
Status Fill(const Proto& proto, const Field& field, std::vector<Out>& out, const Convert& convert) {
  if (proto.has_raw_data()) {
    if (proto.raw_data().size() != out.size() * sizeof(Raw)) {
      return Status::Error("has data that do not fill its shape");
    }
    for (size_t i = 0; i < out.size(); ++i) out[i] = convert(At<Raw>(proto.raw_data(), i));
    return Status::Ok();
  }
  if (static_cast<size_t>(field.size()) != out.size()) {
    return Status::Error("has data that do not fill its shape");
  }
  for (size_t i = 0; i < out.size(); ++i) {
    out[i] = convert(static_cast<Raw>(field.Get(static_cast<int>(i))));
  }
  return Status::Ok();
}

template <typename Raw, typename Field>
Status FillInts(const Proto& proto, const Field& field, Tensor& tensor) {
  tensor = Tensor::Zeros(ElementType::kInt, tensor.shape);
  return Fill<Raw>(proto, field, tensor.ints, [](Raw x) { return static_cast<int64_t>(x); });
}

template <typename Raw, typename Field, typename Convert>
Status FillFloats(const Proto& proto, const Field& field, Tensor& tensor, const Convert& convert) {
  tensor = Tensor::Zeros(ElementType::kFloat, tensor.shape);
  return Fill<Raw>(proto, field, tensor.floats, convert);
}

Status DecodeData(const Proto& proto, Tensor& tensor) {
  const auto plain = [](auto x) { return static_cast<float>(x); };
  switch (proto.data_type()) {
    case Proto::FLOAT:
      return FillFloats<float>(proto, proto.float_data(), tensor, plain);
    case Proto::DOUBLE:
      return FillFloats<double>(proto, proto.double_data(), tensor, plain);
    case Proto::FLOAT16:
      return FillFloats<uint16_t>(proto, proto.int32_data(), tensor, HalfToFloat);
    case Proto::BFLOAT16:
      return FillFloats<uint16_t>(proto, proto.int32_data(), tensor, Bfloat16ToFloat);
    case Proto::INT64:
      return FillInts<int64_t>(proto, proto.int64_data(), tensor);
    case Proto::INT32:
      return FillInts<int32_t>(proto, proto.int32_data(), tensor);
    case Proto::INT16:
      return FillInts<int16_t>(proto, proto.int32_data(), tensor);
    case Proto::INT8:
      return FillInts<int8_t>(proto, proto.int32_data(), tensor);
    case Proto::UINT8:
    case Proto::BOOL:
      return FillInts<uint8_t>(proto, proto.int32_data(), tensor);
    default:
      return Status::Error("has a data type that is not supported");
  }
}

}  // namespace

float HalfToFloat(uint16_t bits) {
  const int exponent = (bits >> 10) & 31;
  const float mantissa = static_cast<float>(bits & 1023);
  float magnitude = std::ldexp(mantissa + (exponent ? 1024.0f : 0.0f), std::max(exponent, 1) - 25);
  if (exponent == 31) {
    magnitude = mantissa == 0 ? std::numeric_limits<float>::infinity()
                              : std::numeric_limits<float>::quiet_NaN();
  }
  return bits & 0x8000 ? -magnitude : magnitude;
}

uint16_t FloatToHalf(float x) {
  const uint16_t sign = std::signbit(x) ? 0x8000 : 0;
  const float magnitude = std::abs(x);
  if (std::isnan(x)) return 0x7e00;
  if (magnitude >= 65520.0f) return static_cast<uint16_t>(sign | 0x7c00);
  int exponent = 0;
  std::frexp(magnitude, &exponent);  // magnitude = fraction * 2^exponent, fraction in [0.5, 1)
  const int shift = std::max(exponent, -13);  // below 2^-14 the spacing stays that of subnormals
  const float steps = std::nearbyint(std::ldexp(magnitude, 11 - shift));  // up to 2048
  // A rounding up to the next power of two carries into the exponent by itself.
  const int bits = static_cast<int>(steps) + (shift + 13) * 1024;
  return static_cast<uint16_t>(sign | (magnitude == 0 ? 0 : bits));
}

float Bfloat16ToFloat(uint16_t bits) {
  return std::bit_cast<float>(static_cast<uint32_t>(bits) << 16);
}

StatusOr<Tensor> DecodeTensor(const Proto& proto) {
  if (proto.data_location() == Proto::EXTERNAL) {
    return Status::Error("is stored in another file; export the model into one file");
  }
  Tensor tensor;
  int64_t count = 1;
  for (const int64_t size : proto.dims()) {
    if (size < 0 || size > kMaxElements || (count *= size) > kMaxElements) {
      return Status::Error("has an impossible shape");
    }
    tensor.shape.push_back(size);
  }
  // Before memory is taken: a damaged shape must not ask for more than the file can fill.
  const int64_t bytes = static_cast<int64_t>(proto.ByteSizeLong());
  if (count > bytes) return Status::Error("has data that do not fill its shape");
  if (Status status = DecodeData(proto, tensor); !status.ok()) return status;
  return tensor;
}

}  // namespace msf
