#include "place_recognition/binary_clustering.h"

#include <array>

#include "util/check.h"

namespace msf {
namespace {

// Counts how many descriptors have each bit.
class BitCounter {
 public:
  void Add(const Descriptor& descriptor) {
    ++total_;
    for (int byte = 0; byte < 32; ++byte) {
      // Spreads 8 bits to the lowest bits of 8 bytes, so that one addition counts them all.
      const uint64_t bits = (descriptor[byte / 8] >> (8 * (byte % 8))) & 0xff;
      pending_[byte] += (bits * 0x8040201008040201u >> 7) & 0x0101010101010101u;
    }
    if (++num_pending_ == 255) Flush();
  }

  // The bits that more than half have.
  Descriptor Majority() {
    Flush();
    Descriptor majority{};
    for (int bit = 0; bit < 256; ++bit) {
      majority[bit / 64] |= static_cast<uint64_t>(2 * counts_[bit] > total_) << (bit % 64);
    }
    return majority;
  }

 private:
  void Flush() {
    for (int byte = 0; byte < 32; ++byte) {
      for (int i = 0; i < 8; ++i) counts_[8 * byte + 7 - i] += (pending_[byte] >> (8 * i)) & 0xff;
    }
    pending_.fill(0);
    num_pending_ = 0;
  }

  std::array<uint64_t, 32> pending_{};
  std::array<uint32_t, 256> counts_{};
  uint32_t total_ = 0;
  int num_pending_ = 0;
};

std::vector<Descriptor> DrawCentres(std::span<const Descriptor> descriptors, int count,
                                    std::mt19937_64& random) {
  std::vector<Descriptor> centres = {descriptors[random() % descriptors.size()]};
  std::vector<uint32_t> cost(descriptors.size(),
                             256 * 256 + 1);  // squared distance to the nearest centre
  while (static_cast<int>(centres.size()) < count) {
    uint64_t sum = 0;
    for (size_t i = 0; i < descriptors.size(); ++i) {
      const auto distance =
          static_cast<uint32_t>(DescriptorDistance(descriptors[i], centres.back()));
      cost[i] = std::min(cost[i], distance * distance);
      sum += cost[i];
    }
    if (sum == 0) break;  // every descriptor is a centre
    uint64_t drawn = random() % sum;
    size_t chosen = 0;
    while (drawn >= cost[chosen]) drawn -= cost[chosen++];
    centres.push_back(descriptors[chosen]);
  }
  return centres;
}

// True when any descriptor changed its cluster.
bool Assign(std::span<const Descriptor> descriptors, BinaryClusters& clusters) {
  bool changed = false;
  for (size_t i = 0; i < descriptors.size(); ++i) {
    int best = 0, best_distance = 257;
    for (int centre = 0; centre < static_cast<int>(clusters.centres.size()); ++centre) {
      const int distance = DescriptorDistance(descriptors[i], clusters.centres[centre]);
      if (distance < best_distance) {
        best_distance = distance;
        best = centre;
      }
    }
    changed |= clusters.members[i] != best;
    clusters.members[i] = best;
  }
  return changed;
}

void MoveCentres(std::span<const Descriptor> descriptors, BinaryClusters& clusters) {
  std::vector<BitCounter> counters(clusters.centres.size());
  std::vector<bool> used(clusters.centres.size(), false);
  for (size_t i = 0; i < descriptors.size(); ++i) {
    counters[clusters.members[i]].Add(descriptors[i]);
    used[clusters.members[i]] = true;
  }
  for (size_t centre = 0; centre < clusters.centres.size(); ++centre) {
    if (used[centre]) clusters.centres[centre] = counters[centre].Majority();
  }
}

void DropEmpty(BinaryClusters& clusters) {
  std::vector<int> new_index(clusters.centres.size(), -1);
  for (const int member : clusters.members) new_index[member] = 0;
  int kept = 0;
  for (size_t centre = 0; centre < clusters.centres.size(); ++centre) {
    if (new_index[centre] < 0) continue;
    clusters.centres[kept] = clusters.centres[centre];
    new_index[centre] = kept++;
  }
  clusters.centres.resize(kept);
  for (int& member : clusters.members) member = new_index[member];
}

}  // namespace

BinaryClusters ClusterBinary(std::span<const Descriptor> descriptors, int count, int max_iterations,
                             std::mt19937_64& random) {
  MSF_CHECK(!descriptors.empty() && count >= 1, "clustering needs descriptors and clusters");
  BinaryClusters clusters{DrawCentres(descriptors, count, random),
                          std::vector<int>(descriptors.size(), -1)};
  Assign(descriptors, clusters);
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    MoveCentres(descriptors, clusters);
    if (!Assign(descriptors, clusters)) break;
  }
  DropEmpty(clusters);
  return clusters;
}

}  // namespace msf
