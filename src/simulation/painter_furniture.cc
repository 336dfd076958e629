// Wood, metal, cloth, doors and leaves.
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "simulation/painter.h"

namespace msf {

cv::Mat PaintWood(cv::Size size, const cv::Scalar& base, Random random) {
  cv::Mat picture(size, CV_8UC3, base);
  // Grain: noise that is stretched along the board.
  cv::Mat grain(std::max(2, size.height / 2), std::max(2, size.width / 24 + 2), CV_8UC3, base);
  cv::RNG rng(random.Next());
  cv::Mat noise(grain.size(), CV_16SC1);
  rng.fill(noise, cv::RNG::NORMAL, 0, 13);
  for (int i = 0; i < static_cast<int>(grain.total()); ++i) {
    for (int c = 0; c < 3; ++c) {
      grain.at<cv::Vec3b>(i)[c] =
          cv::saturate_cast<uint8_t>(base[c] + noise.at<int16_t>(i) * (0.7 + 0.15 * c));
    }
  }
  cv::resize(grain, picture, size, 0, 0, cv::INTER_CUBIC);
  const int knots = static_cast<int>(static_cast<double>(size.area()) / 12000 + random.Uniform());
  for (int i = 0; i < knots; ++i) {
    const cv::Point at(random.Int(0, size.width - 1), random.Int(0, size.height - 1));
    const int r = random.Int(2, 5);
    cv::ellipse(picture, at, {2 * r, r}, 0, 0, 360, base * 0.55, -1, cv::LINE_AA);
    cv::ellipse(picture, at, {3 * r, 2 * r}, 0, 0, 360, base * 0.8, 1, cv::LINE_AA);
  }
  return picture;
}

cv::Mat PaintMetal(cv::Size size, const cv::Scalar& base, Random random) {
  cv::Mat picture(size, CV_8UC3, base);
  AddMottle(picture, 4, 30, random);
  AddMottle(picture, 4, 3, random);
  return picture;
}

cv::Mat PaintFabric(cv::Size size, const cv::Scalar& base, Random random) {
  cv::Mat picture(size, CV_8UC3, base);
  const int kind = random.Int(0, 2);
  const int step = random.Int(12, 26);
  if (kind == 0) {  // plaid
    cv::Mat layer = picture.clone();
    for (int x = random.Int(0, step); x < size.width; x += random.Int(step, 2 * step)) {
      cv::rectangle(layer, cv::Rect(x, 0, random.Int(3, step), size.height),
                    NearbyColor(base, 90, random), -1);
    }
    cv::Mat cross = picture.clone();
    for (int y = random.Int(0, step); y < size.height; y += random.Int(step, 2 * step)) {
      cv::rectangle(cross, cv::Rect(0, y, size.width, random.Int(3, step)),
                    NearbyColor(base, 90, random), -1);
    }
    cv::addWeighted(layer, 0.5, cross, 0.5, 0, picture);
  } else if (kind == 1) {  // stripes
    for (int y = 0; y < size.height; y += random.Int(step, 2 * step)) {
      cv::rectangle(picture, cv::Rect(0, y, size.width, random.Int(4, step)),
                    NearbyColor(base, 100, random), -1);
    }
  }
  // A print: dots, patches and marks that tell one place from another.
  const int prints = size.area() / (kind == 2 ? 500 : 1800);
  for (int i = 0; i < prints; ++i) {
    const cv::Point at(random.Int(0, size.width - 1), random.Int(0, size.height - 1));
    const cv::Scalar color =
        random.Chance(0.4) ? VividColor(random) : NearbyColor(base, 110, random);
    if (random.Chance(0.5))
      cv::circle(picture, at, random.Int(2, 6), color, -1, cv::LINE_AA);
    else
      cv::rectangle(picture, {at, cv::Size(random.Int(4, 13), random.Int(3, 9))}, color, -1);
  }
  AddMottle(picture, 9, 40, random);
  AddMottle(picture, 7, 2.5, random);
  return picture;
}

cv::Mat PaintDoor(cv::Size size, const cv::Scalar& base, Random random) {
  cv::Mat picture = PaintWood({size.height, size.width}, base, random.Fork(1));
  cv::rotate(picture, picture, cv::ROTATE_90_CLOCKWISE);
  const int margin = size.width / 7;
  for (int half = 0; half < 2; ++half) {
    const int top = margin + half * (size.height - margin) / 2;
    const cv::Rect panel(margin, top, size.width - 2 * margin, (size.height - 3 * margin) / 2);
    cv::rectangle(picture, panel, base * 0.6, 3);
    cv::rectangle(picture, panel + cv::Point(3, 3), base * 1.2, 2);
  }
  const cv::Point handle(size.width - margin / 2, size.height / 2);
  cv::rectangle(picture, cv::Rect(handle.x - 5, handle.y - 14, 10, 28), {170, 175, 180}, -1);
  cv::line(picture, handle, handle - cv::Point(margin, 0), {60, 60, 65}, 5, cv::LINE_AA);
  const cv::Rect sign(size.width / 3, size.height / 6, size.width / 3, size.width / 6);
  cv::rectangle(picture, sign, {235, 235, 235}, -1);
  DrawText(picture, sign, sign.height / 2.6, {30, 30, 30}, random);
  return picture;
}

cv::Mat PaintCabinetFront(cv::Size size, const cv::Scalar& base, Random random) {
  cv::Mat picture = PaintWood(size, base, random.Fork(1));
  const int rows = random.Int(2, 4), columns = random.Int(2, 3);
  for (int i = 0; i < rows * columns; ++i) {
    const cv::Rect front(i % columns * size.width / columns, i / columns * size.height / rows,
                         size.width / columns, size.height / rows);
    cv::Mat(picture(front) * random.Uniform(0.85, 1.1)).copyTo(picture(front));
    cv::rectangle(picture, front, base * 0.35, 2);
    const cv::Point middle = (front.tl() + front.br()) / 2;
    cv::line(picture, middle - cv::Point(12, front.height / 4),
             middle + cv::Point(12, -front.height / 4), {50, 50, 50}, 4, cv::LINE_AA);
    if (!random.Chance(0.7)) continue;
    const cv::Rect sticker(middle.x + random.Int(-front.width / 4, 4), middle.y, random.Int(20, 44),
                           random.Int(14, 34));
    cv::rectangle(picture, sticker, VividColor(random), -1);
    DrawText(picture, sticker, 8, {20, 20, 20}, random);
  }
  return picture;
}

cv::Mat PaintLeaves(cv::Size size, Random random) {
  cv::Mat picture(size, CV_8UC3, cv::Scalar(22, 48, 24));
  for (int i = 0; i < size.area() / 120; ++i) {
    const cv::Point at(random.Int(0, size.width - 1), random.Int(0, size.height - 1));
    const cv::Scalar green(random.Uniform(25, 80), random.Uniform(80, 200),
                           random.Uniform(30, 110));
    cv::ellipse(picture, at, {random.Int(7, 16), random.Int(3, 6)}, random.Uniform(0, 180), 0, 360,
                green, -1, cv::LINE_AA);
  }
  return picture;
}

}  // namespace msf
