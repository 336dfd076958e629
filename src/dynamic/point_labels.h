// What is known about the points of one image: does each belong to the static world?
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace msf {

// Why a point has its static probability.
enum class PointReason : uint8_t {
  kStatic,      // nothing speaks against it
  kBox,         // in a detector's box (modes boxes and paper)
  kObject,      // on an object that moves or may move
  kFlow,        // its flow does not follow the camera's motion
  kDepth,       // its depth does not
  kSettled,     // on an object that has come to rest: used with reduced weight
  kReadmitted,  // suspicious, but used with little weight: alone in it, or too few others are left
  kKnown,       // suspicious, but where the map has a static point that looks like it
};
constexpr int kNumPointReasons = 8;
const char* ToString(PointReason reason);

// One entry per feature of the frame.
struct PointLabels {
  std::vector<float> static_probability;  // [0, 1]
  std::vector<PointReason> reason;

  explicit PointLabels(int size = 0)
      : static_probability(size, 1.0f), reason(size, PointReason::kStatic) {}
  int size() const { return static_cast<int>(reason.size()); }
  void Set(int i, PointReason why, float probability) {
    reason[i] = why;
    static_probability[i] = probability;
  }
  // How many points have each reason.
  std::array<int, kNumPointReasons> Counts() const;
};

}  // namespace msf
