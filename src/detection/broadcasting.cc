#include "detection/broadcasting.h"

namespace msf {

StatusOr<Shape> BroadcastShape(const Shape& a, const Shape& b) {
  Shape result(std::max(a.size(), b.size()), 1);
  for (size_t i = 0; i < result.size(); ++i) {
    const int64_t from_a = i < a.size() ? a[a.size() - 1 - i] : 1;
    const int64_t from_b = i < b.size() ? b[b.size() - 1 - i] : 1;
    if (from_a != from_b && from_a != 1 && from_b != 1) {
      return Status::Error("cannot combine " + ToString(a) + " with " + ToString(b));
    }
    result[result.size() - 1 - i] = from_a == 1 ? from_b : from_a;
  }
  return result;
}

Shape BroadcastStrides(const Shape& from, const Shape& to) {
  const Shape dense = DenseStrides(from);
  Shape strides(to.size(), 0);
  const size_t skip = to.size() - from.size();
  for (size_t i = 0; i < from.size(); ++i) {
    strides[skip + i] = from[i] == 1 ? 0 : dense[i];
  }
  return strides;
}

}  // namespace msf
