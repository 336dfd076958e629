// Posters, pages, screens, books, cartons: what people put up, open and stack.
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "simulation/painter.h"

namespace msf {
namespace {

cv::Point Somewhere(cv::Size size, Random& random) {
  return {random.Int(0, size.width - 1), random.Int(0, size.height - 1)};
}

void DrawShape(cv::Mat& picture, double largest, Random& random) {
  const cv::Point at = Somewhere(picture.size(), random);
  const int r = std::max(3, static_cast<int>(largest * random.Uniform(0.2, 1)));
  const cv::Scalar color =
      random.Chance(0.2) ? cv::Scalar::all(random.Chance(0.5) ? 20 : 240) : VividColor(random);
  switch (random.Int(0, 3)) {
    case 0:
      cv::circle(picture, at, r, color, random.Chance(0.7) ? -1 : 3, cv::LINE_AA);
      break;
    case 1:
      cv::rectangle(picture, cv::Rect(at.x - r, at.y - r / 2, 2 * r, r), color, -1);
      break;
    case 2:
      cv::line(picture, at, Somewhere(picture.size(), random), color, random.Int(2, 6),
               cv::LINE_AA);
      break;
    default: {
      std::vector<cv::Point> corners;
      for (int i = 0, n = random.Int(3, 6); i < n; ++i) {
        const double angle = 2 * CV_PI * (i + random.Uniform(-0.3, 0.3)) / n;
        corners.emplace_back(at.x + r * std::cos(angle), at.y + r * std::sin(angle));
      }
      cv::fillPoly(picture, std::vector{corners}, color, cv::LINE_AA);
    }
  }
}

void DrawChecker(cv::Mat& picture, const cv::Rect& area, int columns, Random& random) {
  const cv::Scalar dark = VividColor(random) * 0.4, bright(235, 240, 240);
  const double cell = static_cast<double>(area.width) / columns;
  for (int y = 0; y * cell < area.height; ++y) {
    for (int x = 0; x < columns; ++x) {
      const cv::Rect square(area.x + static_cast<int>(x * cell),
                            area.y + static_cast<int>(y * cell), static_cast<int>(cell) + 1,
                            static_cast<int>(cell) + 1);
      const bool is_dark = ((x + y) % 2 == 0) != random.Chance(0.15);
      cv::rectangle(picture, square & area, is_dark ? dark : bright, -1);
    }
  }
}

void DrawChart(cv::Mat& picture, const cv::Rect& area, Random& random) {
  cv::rectangle(picture, area, {250, 250, 250}, -1);
  for (int i = 1; i < 6; ++i) {
    const int y = area.y + i * area.height / 6;
    cv::line(picture, {area.x, y}, {area.br().x, y}, {190, 190, 190}, 1);
  }
  const int bars = random.Int(5, 9);
  for (int i = 0; i < bars; ++i) {
    const int height = static_cast<int>(area.height * random.Uniform(0.2, 0.9));
    const int width = area.width / bars;
    cv::rectangle(
        picture,
        cv::Rect(area.x + i * width + width / 6, area.br().y - height, 2 * width / 3, height),
        VividColor(random), -1);
  }
  cv::rectangle(picture, area, {40, 40, 40}, 2);
}

void AbstractArt(cv::Mat& picture, Random& random) {
  const double largest = 0.22 * std::min(picture.cols, picture.rows);
  const int count = 18 + picture.size().area() / 2500;
  for (int i = 0; i < count; ++i) DrawShape(picture, largest * (i < 12 ? 1 : 0.35), random);
}

void Notice(cv::Mat& picture, Random& random) {
  const cv::Size size = picture.size();
  const int margin = size.width / 12;
  const cv::Rect title(margin, margin, size.width - 2 * margin, size.height / 6);
  DrawText(picture, title, size.height / 12.0, VividColor(random) * 0.6, random);
  const cv::Rect figure(margin, size.height / 4, size.width - 2 * margin, size.height / 3);
  if (random.Chance(0.5))
    DrawChart(picture, figure, random);
  else
    DrawChecker(picture, figure, random.Int(6, 11), random);
  const cv::Rect body(margin, size.height * 5 / 8, size.width - 2 * margin, size.height / 3);
  DrawText(picture, body, std::max(7.0, size.height / 34.0), {30, 30, 30}, random);
}

}  // namespace

cv::Mat PaintPoster(cv::Size size, Random random) {
  cv::Mat picture(size, CV_8UC3, NearbyColor({215, 220, 225}, 25, random));
  const int kind = random.Int(0, 3);
  if (kind == 0)
    picture = PaintLandscape(size, random.Fork(3));
  else if (kind == 1)
    AbstractArt(picture, random);
  else
    Notice(picture, random);
  AddMottle(picture, 4, 3, random);
  const int frame = std::max(3, size.width / 45);
  cv::rectangle(picture, {frame / 2, frame / 2, size.width - frame, size.height - frame},
                VividColor(random) * 0.5, frame);
  return picture;
}

cv::Mat PaintLandscape(cv::Size size, Random random) {
  cv::Mat picture(size, CV_8UC3);
  for (int y = 0; y < size.height; ++y) {
    const double t = static_cast<double>(y) / size.height;
    picture.row(y).setTo(cv::Scalar(245 - 30 * t, 200 + 30 * t, 140 + 90 * t));
  }
  for (int i = 0; i < 14; ++i) {
    cv::ellipse(picture, {random.Int(0, size.width), random.Int(0, size.height / 3)},
                {random.Int(10, size.width / 7), random.Int(4, 14)}, 0, 0, 360, {250, 250, 250}, -1,
                cv::LINE_AA);
  }
  for (int layer = 0; layer < 4; ++layer) {
    std::vector<cv::Point> ridge = {{0, size.height}};
    double y = size.height * (0.35 + 0.15 * layer);
    for (int x = 0; x <= size.width + 11; x += 12) {
      y += random.Uniform(-8, 8);
      ridge.emplace_back(x, static_cast<int>(y));
    }
    ridge.emplace_back(size.width, size.height);
    cv::fillPoly(picture, std::vector{ridge},
                 cv::Scalar(120 - 25 * layer, 130 - 12 * layer, 70 + 5 * layer), cv::LINE_AA);
  }
  for (int i = 0; i < size.width / 4; ++i) {
    const cv::Point foot(random.Int(0, size.width), random.Int(size.height / 2, size.height));
    const int tall = random.Int(8, 26);
    const std::vector<cv::Point> tree = {
        {foot.x - tall / 3, foot.y}, {foot.x, foot.y - tall}, {foot.x + tall / 3, foot.y}};
    cv::fillConvexPoly(picture, tree,
                       cv::Scalar(30, random.Uniform(50, 150), random.Uniform(20, 90)),
                       cv::LINE_AA);
  }
  for (int i = 0; i < 5; ++i) {
    const cv::Rect house(random.Int(0, size.width), random.Int(size.height / 2, size.height),
                         random.Int(14, 34), random.Int(12, 26));
    cv::rectangle(picture, house, VividColor(random), -1);
    cv::rectangle(picture, house + cv::Point(4, 4) + cv::Size(-house.width / 2, -house.height / 2),
                  {40, 40, 50}, -1);
  }
  return picture;
}

cv::Mat PaintPage(cv::Size size, Random random) {
  cv::Mat picture(size, CV_8UC3, NearbyColor({238, 240, 240}, 10, random));
  const int margin = size.width / 9;
  const cv::Rect body(margin, margin, size.width - 2 * margin, size.height - 2 * margin);
  DrawText(picture, body, std::max(7.0, size.height / 26.0), {35, 30, 30}, random);
  if (random.Chance(0.5)) {
    DrawChart(picture, {size.width / 2, size.height / 2, size.width / 3, size.height / 4}, random);
  }
  return picture;
}

cv::Mat PaintScreen(cv::Size size, Random random) {
  cv::Mat picture = PaintLandscape(size, random.Fork(5));
  const int windows = random.Int(3, 4);
  for (int i = 0; i < windows; ++i) {
    const cv::Rect window = cv::Rect(random.Int(0, size.width / 2), random.Int(0, size.height / 2),
                                     random.Int(size.width / 3, size.width * 2 / 3),
                                     random.Int(size.height / 3, size.height * 2 / 3)) &
                            cv::Rect({8, 8}, cv::Size(size.width - 16, size.height - 30));
    const bool dark = random.Chance(0.5);
    cv::rectangle(picture, window, dark ? cv::Scalar(45, 38, 35) : cv::Scalar(245, 245, 245), -1);
    cv::rectangle(picture, {window.tl(), cv::Size(window.width, 14)}, VividColor(random), -1);
    const cv::Rect text(window.x + 8, window.y + 16, window.width - 16, window.height - 20);
    DrawText(picture, text, 9, dark ? VividColor(random) : cv::Scalar(40, 40, 40), random);
  }
  for (int i = 0; i < 9; ++i) {
    cv::rectangle(picture, {10 + 24 * i, size.height - 20, 16, 14}, VividColor(random), -1);
  }
  cv::rectangle(picture, {0, 0, size.width, size.height}, {25, 25, 25}, 14);
  return picture;
}

cv::Mat PaintKeyboard(cv::Size size, Random random) {
  cv::Mat picture(size, CV_8UC3, cv::Scalar(45, 45, 48));
  const double pitch = size.height / 5.6;
  for (int row = 0; row < 5; ++row) {
    double x = pitch * 0.3;
    while (x < size.width - pitch) {
      const double width = pitch * (random.Chance(0.12) ? 1.9 : 1);
      const cv::Rect key(static_cast<int>(x), static_cast<int>(pitch * (0.3 + row)),
                         static_cast<int>(width * 0.82), static_cast<int>(pitch * 0.82));
      cv::rectangle(picture, key, {205, 208, 210}, -1);
      DrawText(picture, key, pitch * 0.35, {20, 20, 20}, random);
      cv::circle(picture, (key.tl() + key.br()) / 2, 2, {20, 20, 20}, -1);
      x += width;
    }
  }
  return picture;
}

cv::Mat PaintCarton(cv::Size size, Random random) {
  const bool plain = random.Chance(0.4);
  const cv::Scalar base = plain ? cv::Scalar(105, 150, 185) : VividColor(random);
  cv::Mat picture(size, CV_8UC3, base);
  AddMottle(picture, 6, 12, random);
  for (int i = 0; i < (plain ? 3 : 9); ++i)
    DrawShape(picture, 0.18 * std::min(size.width, size.height), random);
  const cv::Rect label(random.Int(4, size.width / 4), random.Int(4, size.height / 4),
                       size.width * 5 / 8, size.height / 2);
  cv::rectangle(picture, label, {240, 240, 240}, -1);
  DrawText(picture, label, std::max(7.0, label.height / 5.0), VividColor(random) * 0.5, random);
  for (int x = size.width / 2; x < size.width - 10; x += random.Int(3, 7)) {  // bar code
    cv::rectangle(picture, {x, size.height * 4 / 5, random.Int(1, 3), size.height / 8},
                  {15, 15, 15}, -1);
  }
  return picture;
}

cv::Mat PaintBookCover(cv::Size size, Random random) {
  cv::Mat picture(size, CV_8UC3, VividColor(random));
  for (int i = 0; i < 6; ++i) DrawShape(picture, 0.25 * size.width, random);
  const cv::Rect title(size.width / 10, size.height / 8, size.width * 4 / 5, size.height / 3);
  DrawText(picture, title, size.height / 11.0, {245, 245, 245}, random);
  AddMottle(picture, 4, 3, random);
  return picture;
}

cv::Mat PaintBookSpine(cv::Size size, Random random) {
  const cv::Scalar base = VividColor(random);
  cv::Mat lying(size.width, size.height, CV_8UC3, base);
  const cv::Scalar ink = random.Chance(0.5) ? cv::Scalar(240, 240, 240) : cv::Scalar(20, 20, 20);
  const double letter = std::max(6.0, 0.45 * size.width);
  const cv::Rect title(size.height / 8,
                       std::max(0, static_cast<int>((size.width - 1.7 * letter) / 2)),
                       size.height * 5 / 8, size.width);
  DrawText(lying, title, letter, ink, random);
  for (int i = random.Int(1, 3); i > 0; --i) {
    const int x = random.Chance(0.5) ? random.Int(0, size.height / 10)
                                     : random.Int(size.height * 4 / 5, size.height);
    cv::rectangle(lying, {x, 0, random.Int(3, 9), size.width}, VividColor(random), -1);
  }
  cv::rectangle(lying, {0, 0, size.height, size.width}, base * 0.5, 1);
  cv::Mat picture;
  cv::rotate(lying, picture, cv::ROTATE_90_CLOCKWISE);
  AddMottle(picture, 4, 3, random);
  return picture;
}

cv::Mat PaintBall(cv::Size size, Random random) {
  cv::Mat picture(size, CV_8UC3, VividColor(random));
  for (int i = 0; i < 5; ++i) {
    cv::rectangle(picture, {i * size.width / 5, 0, size.width / 10, size.height},
                  VividColor(random), -1);
  }
  for (int i = 0; i < 40; ++i) DrawShape(picture, 0.07 * size.width, random);
  return picture;
}

}  // namespace msf
