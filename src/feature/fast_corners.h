// FAST-9 corners (Rosten and Drummond, ECCV 2006): a pixel is a corner of contrast t when 9
// neighbouring pixels of the circle of radius 3 around it are all brighter than it by more than t,
// or all darker.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace msf {

// A corner at a pixel of one pyramid level: it is one for every contrast below `score`.
struct Corner {
  int16_t x = 0;
  int16_t y = 0;
  uint8_t score = 0;
};

// Writes the score of every pixel of `image` (8-bit grey) inside the rectangle into `scores` (same
// size, outside untouched). The rectangle keeps at least 3 px from the image's edges.
void ComputeFastScores(const cv::Mat& image, const cv::Rect& area, cv::Mat& scores);

// The pixels of `area` whose score exceeds `min_score` and that of each of their 8 neighbours, row
// by row. `scores` must be filled one pixel beyond the area.
void FindScorePeaks(const cv::Mat& scores, const cv::Rect& area, int min_score,
                    std::vector<Corner>& corners);

// Two thresholds: in every cell of about `cell_size_px` drops the corners whose score does not
// exceed `strong_score`, unless the cell has only such. Keeps the order.
void KeepStrongPerCell(const cv::Rect& area, int cell_size_px, int strong_score,
                       std::vector<Corner>& corners);

}  // namespace msf
