// Features made by hand, for the tests of matching.
#pragma once

#include <cstdint>
#include <random>

#include "feature/bag_of_words.h"
#include "feature/frame_features.h"

namespace msf {

// Unrelated descriptors (about 128 bits apart) for different seeds.
inline Descriptor RandomDescriptor(uint64_t seed) {
  std::mt19937_64 random(seed);
  return {random(), random(), random(), random()};
}

// A descriptor `count` bits away.
inline Descriptor FlipBits(Descriptor descriptor, int count) {
  for (int bit = 0; bit < count; ++bit) {
    const int place = bit * 5 % 256;
    descriptor[place / 64] ^= uint64_t{1} << (place % 64);
  }
  return descriptor;
}

struct TestFeatures {
  FrameFeatures features;
  BagOfWords words;  // all features below one node, unless put elsewhere

  int Add(float u_px, float v_px, const Descriptor& descriptor, int level = 0,
          float u_right_px = -1, float angle_rad = 0) {
    features.uv_px.emplace_back(u_px, v_px);
    features.image_px.emplace_back(u_px, v_px);
    features.depth_m.push_back(0);
    features.u_right_px.push_back(u_right_px);
    features.angle_rad.push_back(angle_rad);
    features.level.push_back(static_cast<uint8_t>(level));
    features.static_weight.push_back(1);
    features.descriptors.push_back(descriptor);
    return features.size() - 1;
  }
  void PutBelowNode(uint32_t node, int feature) {
    if (words.nodes.empty() || words.nodes.back().first != node) words.nodes.push_back({node, {}});
    words.nodes.back().second.push_back(feature);
  }
};

}  // namespace msf
