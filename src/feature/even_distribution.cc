#include "feature/even_distribution.h"

#include <algorithm>
#include <cmath>

namespace msf {
namespace {

// A rectangle [x0, x1) x [y0, y1) and its corners, a contiguous part of the list.
struct Cell {
  float x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  int begin = 0, end = 0;
  int size() const { return end - begin; }
  // Neighbouring corners are at least 2 px apart, so a cell this small holds one; keeps equal
  // positions from splitting for ever.
  bool Divisible() const { return size() > 1 && (x1 - x0 > 1 || y1 - y0 > 1); }
};

// Strictly ordered, so that a choice among equals does not depend on the order they come in.
bool Stronger(const Corner& a, const Corner& b) {
  if (a.score != b.score) return a.score > b.score;
  return a.y != b.y ? a.y < b.y : a.x < b.x;
}

class Quadtree {
 public:
  Quadtree(const cv::Rect& area, int count, std::vector<Corner>& corners)
      : count_(count), corners_(corners) {
    AddRoots(area);
  }

  // Puts each cell's strongest corner first in the cell's part of the list; returns their indices.
  std::vector<int> Select() {
    while (SplitRound()) {
    }
    std::vector<int> chosen;
    chosen.reserve(cells_.size());
    for (const Cell& cell : cells_) {
      const auto begin = corners_.begin() + cell.begin, end = corners_.begin() + cell.end;
      std::iter_swap(begin, std::min_element(begin, end, Stronger));
      chosen.push_back(cell.begin);
    }
    return chosen;
  }

 private:
  // Nearly square cells, so that their quarters are square too.
  void AddRoots(const cv::Rect& area) {
    const float width = static_cast<float>(area.width), height = static_cast<float>(area.height);
    const float side = std::max(std::min(width, height) / 3, 1.0f);
    const int columns = std::max(1, static_cast<int>(std::lround(width / side)));
    const int rows = std::max(1, static_cast<int>(std::lround(height / side)));
    const float x0 = static_cast<float>(area.x), y0 = static_cast<float>(area.y);
    int begin = 0;
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        Cell cell{x0 + width * column / columns,
                  y0 + height * row / rows,
                  x0 + width * (column + 1) / columns,
                  y0 + height * (row + 1) / rows,
                  begin,
                  begin};
        cell.end = Partition(begin, static_cast<int>(corners_.size()), [&](const Corner& corner) {
          return corner.x < cell.x1 && corner.y < cell.y1;
        });
        begin = cell.end;
        if (cell.size() > 0) cells_.push_back(cell);
      }
    }
  }

  // Quarters all cells that can be, as long as the count allows; false when nothing more is to do.
  bool SplitRound() {
    std::vector<int> order;
    for (int i = 0; i < static_cast<int>(cells_.size()); ++i) {
      if (cells_[i].Divisible()) order.push_back(i);
    }
    if (order.empty() || static_cast<int>(cells_.size()) >= count_) return false;
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return cells_[a].size() > cells_[b].size(); });
    for (const int i : order) {
      Split(i);
      if (static_cast<int>(cells_.size()) >= count_) return false;
    }
    return true;
  }

  // The cell becomes its first quarter that holds a corner; the others are appended.
  void Split(int index) {
    const Cell cell = cells_[index];
    const float x = (cell.x0 + cell.x1) / 2, y = (cell.y0 + cell.y1) / 2;
    const int upper =
        Partition(cell.begin, cell.end, [&](const Corner& corner) { return corner.y < y; });
    const int upper_left =
        Partition(cell.begin, upper, [&](const Corner& corner) { return corner.x < x; });
    const int lower_left =
        Partition(upper, cell.end, [&](const Corner& corner) { return corner.x < x; });
    bool replaced = false;
    for (const Cell& quarter : {Cell{cell.x0, cell.y0, x, y, cell.begin, upper_left},
                                Cell{x, cell.y0, cell.x1, y, upper_left, upper},
                                Cell{cell.x0, y, x, cell.y1, upper, lower_left},
                                Cell{x, y, cell.x1, cell.y1, lower_left, cell.end}}) {
      if (quarter.size() == 0) continue;
      // Once the count is reached a quarter more would be one point too many: it stays with the
      // last one.
      if (replaced && static_cast<int>(cells_.size()) >= count_) {
        cells_.back().end = cell.end;
        return;
      }
      if (replaced) {
        cells_.push_back(quarter);
      } else {
        cells_[index] = quarter;
      }
      replaced = true;
    }
  }

  template <typename Predicate>
  int Partition(int begin, int end, const Predicate& first) {
    return static_cast<int>(
        std::partition(corners_.begin() + begin, corners_.begin() + end, first) - corners_.begin());
  }

  const int count_;
  std::vector<Corner>& corners_;
  std::vector<Cell> cells_;
};

}  // namespace

std::vector<Corner> DistributeEvenly(const cv::Rect& area, int count, double even_share,
                                     std::vector<Corner>& corners) {
  if (count <= 0 || corners.empty()) return {};
  const auto keep_strongest = [&](int number, std::vector<int>& indices) {
    if (static_cast<int>(indices.size()) <= number) return;
    std::nth_element(indices.begin(), indices.begin() + number, indices.end(),
                     [&](int a, int b) { return Stronger(corners[a], corners[b]); });
    indices.resize(number);
  };
  const int num_even = static_cast<int>(std::lround(even_share * count));
  std::vector<int> chosen = Quadtree(area, num_even, corners).Select();
  keep_strongest(num_even, chosen);  // the first cells may be more than the points wanted
  std::vector<bool> taken(corners.size(), false);
  for (const int i : chosen) taken[i] = true;
  std::vector<int> rest;
  for (int i = 0; i < static_cast<int>(corners.size()); ++i) {
    if (!taken[i]) rest.push_back(i);
  }
  keep_strongest(count - static_cast<int>(chosen.size()), rest);
  chosen.insert(chosen.end(), rest.begin(), rest.end());
  std::vector<Corner> result;
  result.reserve(chosen.size());
  for (const int i : chosen) result.push_back(corners[i]);
  return result;
}

}  // namespace msf
