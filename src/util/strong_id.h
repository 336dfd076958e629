// Integers that cannot be mistaken for each other: KeyFrameId and MapPointId are different types.
#pragma once

#include <compare>
#include <cstdint>
#include <functional>

namespace msf {

template <typename Tag>
class StrongId {
 public:
  constexpr StrongId() = default;
  constexpr explicit StrongId(int64_t value) : value_(value) {}

  constexpr bool valid() const { return value_ >= 0; }
  constexpr int64_t value() const { return value_; }
  friend constexpr auto operator<=>(StrongId, StrongId) = default;  // NOLINT(modernize-use-nullptr)

 private:
  int64_t value_ = -1;
};

using FrameId = StrongId<struct FrameIdTag>;
using KeyFrameId = StrongId<struct KeyFrameIdTag>;
using MapPointId = StrongId<struct MapPointIdTag>;
using MapId = StrongId<struct MapIdTag>;

}  // namespace msf

template <typename Tag>
struct std::hash<msf::StrongId<Tag>> {
  size_t operator()(msf::StrongId<Tag> id) const noexcept {
    return std::hash<int64_t>()(id.value());
  }
};
