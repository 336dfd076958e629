// What the static world looked like a moment ago, in depth: surfaces that are still there stand
// still, and where the camera has seen through, something has come in since.
#pragma once

#include <algorithm>
#include <deque>
#include <optional>

#include "dynamic/block_rays.h"
#include "dynamic/dynamic_options.h"
#include "geometry/rigid3d.h"

namespace msf {

enum class BlockVerdict : uint8_t {
  kUnknown,    // no depth, not seen before, or hidden before
  kConfirmed,  // a surface that was there before, outside all masks
  kSomebody,   // a surface that was there before and belonged to somebody
  kIntruder,   // the camera has seen through this place before
};

// To whom a cell of a view belongs.
enum class CellOwner : uint8_t {
  kWorld,
  kDoubtful,  // it may belong to an object
  kSomebody,  // an object of a class that moves by itself
};

// Verdicts per block of 2 x 2 cells of CoarseDepth.
class BlockVerdicts {
 public:
  static constexpr int kBlockCells = BlockRays::kBlockCells;

  BlockVerdicts() = default;
  BlockVerdicts(int rows, int cols)
      : verdicts_(rows, cols, static_cast<uint8_t>(BlockVerdict::kUnknown)) {}
  int rows() const { return verdicts_.rows; }
  int cols() const { return verdicts_.cols; }
  BlockVerdict At(int row, int col) const { return static_cast<BlockVerdict>(verdicts_(row, col)); }
  void Set(int row, int col, BlockVerdict verdict) {
    verdicts_(row, col) = static_cast<uint8_t>(verdict);
  }
  BlockVerdict OfCell(const cv::Point& cell) const {
    if (verdicts_.empty()) return BlockVerdict::kUnknown;
    return At(std::min(cell.y / kBlockCells, rows() - 1),
              std::min(cell.x / kBlockCells, cols() - 1));
  }

 private:
  cv::Mat1b verdicts_;
};

class Background {
 public:
  Background(const BackgroundOptions& options, const Camera& camera)
      : options_(options), camera_(camera), rays_(camera) {}

  // Keeps a view for later comparison. `owners`: a CellOwner per cell of the depth; empty: all
  // belong to the world. `steady`: the camera turned slowly.
  void Remember(double time_s, const CoarseDepth& depth, const cv::Mat1b& owners,
                const Rigid3d& T_cw, bool steady);
  // Compares depth seen from T_cw with views of some age. What differs is new only where the
  // camera turned slowly (`steady`) both times: depth is not taken at the very time of the pose.
  BlockVerdicts Compare(double time_s, const CoarseDepth& depth, const Rigid3d& T_cw,
                        bool steady) const;
  // The world's coordinates have changed: T_old_new takes new ones to old ones.
  void ChangeWorld(const Rigid3d& T_old_new);
  void Forget() { views_.clear(); }
  const BlockRays& rays() const { return rays_; }

 private:
  struct View {
    double time_s = 0;
    CoarseDepth depth;
    cv::Mat1b owners;
    Rigid3d T_cw;
    bool steady = false;
    // Depths around each cell, found once since every view is compared with for seconds.
    cv::Mat1f nearest_m, farthest_m;  // of the cell and those beside it; none: infinity and 0
    cv::Mat1f clear_m;  // up to here the camera saw through, two cells around; 0: not known

    CellOwner OwnerOf(int row, int col) const {
      return owners.empty() ? CellOwner::kWorld : static_cast<CellOwner>(owners(row, col));
    }
  };
  // How many views say what of a block.
  struct Votes {
    int confirmed = 0, somebody = 0, intruder = 0;

    // Whatever the views that are left say.
    bool IsConfirmed(int views_left) const {
      return confirmed > 0 && confirmed >= std::max(somebody, intruder) + views_left;
    }
  };
  std::vector<const View*> Choose(double time_s) const;
  // To whom the depth belongs that the view shows in the cell or beside it; nobody knows where it
  // shows another. The world comes first, what is in doubt last.
  static std::optional<CellOwner> OwnerOfDepth(const View& view, const cv::Point& cell,
                                               double depth_m, double tolerance_m);
  BlockVerdict Decide(const Votes& votes) const;
  BlockVerdict CompareWith(const View& view, const Eigen::Vector3d& p_past) const;

  BackgroundOptions options_;
  Camera camera_;
  BlockRays rays_;
  std::deque<View> views_;  // oldest first
};

}  // namespace msf
