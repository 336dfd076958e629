#include "optimization/bundle_layout.h"

#include <numeric>

#include "optimization/bundle_adjustment.h"

namespace msf {
namespace {

// Sorts `items` stably by key(item) in [0, num_keys) in linear time; returns where each key begins,
// and the end.
template <typename Item, typename Key>
std::vector<int> CountingSort(std::vector<Item>& items, int num_keys, Key key) {
  std::vector<int> begin(num_keys + 1, 0);
  for (const Item& item : items) ++begin[key(item) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<int> next(begin.begin(), begin.end() - 1);
  std::vector<Item> sorted(items.size());
  for (const Item& item : items) sorted[next[key(item)]++] = item;
  items = std::move(sorted);
  return begin;
}

}  // namespace

BundleLayout::BundleLayout(const BundleProblem& problem, const std::vector<uint8_t>& active) {
  for (const BundlePose& pose : problem.poses) slot.push_back(pose.fixed ? -1 : num_free_poses++);
  for (size_t i = 0; i < active.size(); ++i) {
    if (active[i]) places.push_back({static_cast<int>(i), slot[problem.observations[i].pose]});
  }
  CountingSort(places, num_free_poses + 1, [](const Place& place) { return place.slot + 1; });
  begin = CountingSort(places, static_cast<int>(problem.points.size()), [&](const Place& place) {
    return problem.observations[place.observation].point;
  });
}

}  // namespace msf
