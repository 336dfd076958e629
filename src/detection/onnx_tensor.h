// Tensors of ONNX files. The only headers that may include this are those that deal with the file
// format.
#pragma once

#define ONNX_ML 1
#ifndef ONNX_NAMESPACE
#define ONNX_NAMESPACE onnx
#endif
#include <onnx/onnx_pb.h>

#include "detection/tensor.h"
#include "util/status.h"

namespace msf {

// Decodes any numeric type; half, bfloat16 and double become float, all integers and bool int64.
// Errors do not name the tensor.
StatusOr<Tensor> DecodeTensor(const onnx::TensorProto& proto);

// IEEE half precision and bfloat16 from their bits.
float HalfToFloat(uint16_t bits);
float Bfloat16ToFloat(uint16_t bits);
// The nearest half precision number, ties to even; too large ones become infinite.
uint16_t FloatToHalf(float x);

}  // namespace msf
