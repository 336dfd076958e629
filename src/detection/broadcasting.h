// NumPy-style broadcasting for the reference operators.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>

#include "detection/tensor.h"
#include "util/status.h"

namespace msf {

// The common shape of two operands, or an error that names both.
StatusOr<Shape> BroadcastShape(const Shape& a, const Shape& b);

// Strides in elements with which an operand of shape `from` is read along `to`; 0 where it repeats.
Shape BroadcastStrides(const Shape& from, const Shape& to);

// Calls visit(offset in the dense result, offset of a, offset of b) for every element of `shape`.
template <typename Visit>
void ForEachBroadcast(const Shape& shape, const Shape& a_strides, const Shape& b_strides,
                      const Visit& visit) {
  const int64_t count = NumElements(shape);
  if (count == 0) return;
  const size_t rank = shape.size();
  const int64_t inner = rank ? shape.back() : 1;
  const int64_t a_inner = rank ? a_strides.back() : 0;
  const int64_t b_inner = rank ? b_strides.back() : 0;
  Shape index(rank, 0);
  int64_t a = 0;
  int64_t b = 0;
  for (int64_t out = 0; out < count; out += inner) {
    for (int64_t i = 0; i < inner; ++i) visit(out + i, a + i * a_inner, b + i * b_inner);
    for (size_t d = rank > 0 ? rank - 1 : 0; d-- > 0;) {
      a += a_strides[d];
      b += b_strides[d];
      if (++index[d] < shape[d]) break;
      a -= a_strides[d] * shape[d];
      b -= b_strides[d] * shape[d];
      index[d] = 0;
    }
  }
}

}  // namespace msf
