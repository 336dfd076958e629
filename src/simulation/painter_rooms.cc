// Walls, floors, ceilings and rugs.
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "simulation/painter.h"

namespace msf {
namespace {

// Walls are darker near floor and ceiling and in the corners, where less light arrives.
void DarkenBorders(cv::Mat& picture, int reach, double strength) {
  for (int y = 0; y < picture.rows; ++y) {
    const double from_edge = std::min(y, picture.rows - 1 - y);
    const double vertical = strength * std::exp(-from_edge / reach);
    cv::Vec3b* row = picture.ptr<cv::Vec3b>(y);
    for (int x = 0; x < picture.cols; ++x) {
      const double from_side = std::min(x, picture.cols - 1 - x);
      const double factor = (1 - vertical) * (1 - strength * std::exp(-from_side / reach));
      for (int c = 0; c < 3; ++c) row[x][c] = static_cast<uint8_t>(row[x][c] * factor);
    }
  }
}

// Marks that surfaces collect: holes, scratches, blobs of filler.
void AddWear(cv::Mat& picture, double per_megatexel, Random& random) {
  const int count = static_cast<int>(per_megatexel * static_cast<double>(picture.total()) * 1e-6);
  for (int i = 0; i < count; ++i) {
    const cv::Point at(random.Int(0, picture.cols - 1), random.Int(0, picture.rows - 1));
    const cv::Scalar color = random.Chance(0.6) ? cv::Scalar::all(random.Uniform(50, 130))
                                                : cv::Scalar::all(random.Uniform(220, 255));
    if (random.Chance(0.8)) {
      cv::ellipse(picture, at, {random.Int(1, 3), random.Int(1, 2)}, random.Uniform(0, 180), 0, 360,
                  color, -1, cv::LINE_AA);
    } else {
      const cv::Point to(at.x + random.Int(-7, 7), at.y + random.Int(-7, 7));
      cv::line(picture, at, to, color, 1, cv::LINE_AA);
    }
  }
}

void DrawFlower(cv::Mat& picture, cv::Point at, int radius, Random& random) {
  const cv::Scalar petal = VividColor(random), heart = VividColor(random);
  const int petals = random.Int(4, 7);
  const double turn = random.Uniform(0, 6.3);
  for (int i = 0; i < petals; ++i) {
    const double angle = turn + 2 * CV_PI * i / petals;
    const cv::Point center(at.x + static_cast<int>(radius * 0.6 * std::cos(angle)),
                           at.y + static_cast<int>(radius * 0.6 * std::sin(angle)));
    cv::ellipse(picture, center, {radius / 2, radius / 3}, angle * 180 / CV_PI, 0, 360, petal, -1,
                cv::LINE_AA);
  }
  cv::circle(picture, at, std::max(1, radius / 3), heart, -1, cv::LINE_AA);
}

}  // namespace

cv::Mat PaintPlaster(cv::Size size, const cv::Scalar& base, Random random) {
  cv::Mat picture(size, CV_8UC3, base);
  AddMottle(picture, 5, 90, random);
  AddMottle(picture, 5, 14, random);
  AddMottle(picture, 7, 4, random);
  AddWear(picture, 1800, random);
  DarkenBorders(picture, 40, 0.18);
  return picture;
}

cv::Mat PaintWallpaper(cv::Size size, const cv::Scalar& base, Random random) {
  cv::Mat picture(size, CV_8UC3, base);
  const int stripe = 60;
  for (int x = 0; x < size.width; x += stripe) {
    cv::rectangle(picture, cv::Rect(x, 0, random.Int(20, 44), size.height),
                  NearbyColor(base, 16, random), -1);
  }
  for (int x = stripe / 2; x < size.width; x += stripe) {
    for (int y = 25; y < size.height; y += 55) {
      const cv::Point at(x + random.Int(-12, 12), y + random.Int(-12, 12));
      if (random.Chance(0.75)) DrawFlower(picture, at, random.Int(8, 15), random);
    }
  }
  AddMottle(picture, 6, 60, random);
  AddMottle(picture, 5, 4, random);
  DarkenBorders(picture, 40, 0.18);
  return picture;
}

cv::Mat PaintParquet(cv::Size size, Random random) {
  const cv::Scalar base(88, 128, 172);
  cv::Mat picture(size, CV_8UC3, base);
  const int plank = 22;
  for (int y = 0; y < size.height; y += plank) {
    for (int x = -random.Int(0, 200); x < size.width;) {
      const int length = random.Int(90, 240);
      const cv::Rect board = cv::Rect(x, y, length, plank) & cv::Rect({0, 0}, size);
      if (!board.empty()) {
        cv::Mat wood = picture(board);
        PaintWood(board.size(), NearbyColor(base, 32, random), random.Fork(random.Next()))
            .copyTo(wood);
        cv::rectangle(picture, cv::Rect(x, y, length, plank), {40, 60, 80}, 1);
      }
      x += length;
    }
  }
  AddWear(picture, 350, random);
  DarkenBorders(picture, 50, 0.25);
  return picture;
}

cv::Mat PaintCarpet(cv::Size size, const cv::Scalar& base, Random random) {
  cv::Mat picture(size, CV_8UC3, base);
  const int tile = 100;
  for (int y = 0; y < size.height; y += tile) {
    for (int x = 0; x < size.width; x += tile) {
      cv::rectangle(picture, cv::Rect(x, y, tile, tile), NearbyColor(base, 12, random), -1);
      for (int i = 0; i < 10; ++i) {
        const cv::Point at(x + random.Int(0, tile), y + random.Int(0, tile));
        cv::rectangle(picture, {at, cv::Size(random.Int(4, 22), random.Int(3, 10))},
                      NearbyColor(base, 55, random), -1);
      }
    }
  }
  AddMottle(picture, 9, 2.5, random);
  DarkenBorders(picture, 50, 0.25);
  return picture;
}

cv::Mat PaintCeilingPanels(cv::Size size, Random random) {
  cv::Mat picture(size, CV_8UC3, cv::Scalar(222, 228, 230));
  AddMottle(picture, 5, 3, random);
  const int panel = 75;
  for (int y = 0; y < size.height; y += panel) {
    for (int x = 0; x < size.width; x += panel) {
      for (int i = 0; i < 26; ++i) {
        const cv::Point hole(x + random.Int(4, panel - 4), y + random.Int(4, panel - 4));
        cv::circle(picture, hole, random.Int(1, 2), cv::Scalar::all(random.Uniform(90, 150)), -1,
                   cv::LINE_AA);
      }
      if (random.Chance(0.08))
        cv::rectangle(picture, cv::Rect(x, y, panel, panel), {255, 255, 255}, -1);
      cv::rectangle(picture, cv::Rect(x, y, panel, panel), {150, 155, 158}, 2);
    }
  }
  return picture;
}

cv::Mat PaintRug(cv::Size size, Random random) {
  const cv::Scalar base = VividColor(random);
  cv::Mat picture(size, CV_8UC3, base);
  for (int ring = 0; ring < 4; ++ring) {
    const int inset = 8 + 22 * ring;
    if (2 * inset + 10 >= std::min(size.width, size.height)) break;
    const cv::Rect frame(inset, inset, size.width - 2 * inset, size.height - 2 * inset);
    cv::rectangle(picture, frame, VividColor(random), random.Int(4, 12));
  }
  for (int i = 0; i < size.area() / 1500; ++i) {
    const cv::Point at(random.Int(20, size.width - 20), random.Int(20, size.height - 20));
    const int r = random.Int(5, 16);
    const std::vector<cv::Point> diamond = {
        {at.x, at.y - r}, {at.x + r / 2 + 3, at.y}, {at.x, at.y + r}, {at.x - r / 2 - 3, at.y}};
    if (random.Chance(0.5))
      cv::fillConvexPoly(picture, diamond, VividColor(random), cv::LINE_AA);
    else
      DrawFlower(picture, at, r, random);
  }
  AddMottle(picture, 8, 2.5, random);
  return picture;
}

}  // namespace msf
