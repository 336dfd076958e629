// What all painters share: colours, mottle, writing.
#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "simulation/painter.h"

namespace msf {

cv::Scalar VividColor(Random& random) {
  const cv::Mat hsv(1, 1, CV_8UC3,
                    cv::Scalar(random.Int(0, 179), random.Int(110, 230), random.Int(90, 230)));
  cv::Mat bgr;
  cv::cvtColor(hsv, bgr, cv::COLOR_HSV2BGR);
  const cv::Vec3b color = bgr.at<cv::Vec3b>(0, 0);
  return {double(color[0]), double(color[1]), double(color[2])};
}

cv::Scalar NearbyColor(const cv::Scalar& base, double spread, Random& random) {
  const double common = random.Uniform(-spread, spread);
  cv::Scalar color;
  for (int i = 0; i < 3; ++i) {
    color[i] = std::clamp(base[i] + common + random.Uniform(-spread, spread) / 3, 0., 255.);
  }
  return color;
}

void AddMottle(cv::Mat& picture, double contrast, double texels, Random& random) {
  const cv::Size coarse(std::max(2, static_cast<int>(picture.cols / texels) + 1),
                        std::max(2, static_cast<int>(picture.rows / texels) + 1));
  cv::Mat noise(coarse, CV_16SC1), fine;
  cv::RNG rng(random.Next());
  rng.fill(noise, cv::RNG::NORMAL, 0, contrast * 16);
  cv::resize(noise, fine, picture.size(), 0, 0, cv::INTER_CUBIC);
  for (int y = 0; y < picture.rows; ++y) {
    uint8_t* row = picture.ptr<uint8_t>(y);
    const int16_t* offset = fine.ptr<int16_t>(y);
    for (int x = 0; x < picture.cols; ++x) {
      for (int c = 0; c < 3; ++c)
        row[3 * x + c] = cv::saturate_cast<uint8_t>(row[3 * x + c] + offset[x] / 16);
    }
  }
}

void DrawText(cv::Mat& picture, const cv::Rect& area, double letter, const cv::Scalar& ink,
              Random& random) {
  static constexpr char kLetters[] = "eeettaaooiinnsshhrrddllucmfwypvbgkjqxzEKMRSTW0123456789";
  const double scale = letter / 21;  // Hershey's simplex capitals are 21 units high
  const int thickness = std::max(1, static_cast<int>(letter / 7));
  const int num_lines = static_cast<int>((area.height - 1.3 * letter) / (1.8 * letter) + 1);
  for (int line = 0; line < num_lines; ++line) {
    const double y = area.y + (1.3 + 1.8 * line) * letter;
    double x = area.x;
    const double end = area.br().x - (random.Chance(0.2) ? random.Uniform(0, 0.6) * area.width : 0);
    while (true) {
      std::string word;
      for (int i = random.Int(2, 9); i > 0; --i)
        word += kLetters[random.Int(0, sizeof(kLetters) - 2)];
      const double width = 0.85 * letter * static_cast<double>(word.size());
      if (x + width > end) break;
      cv::putText(picture, word, cv::Point2d(x, y), cv::FONT_HERSHEY_SIMPLEX, scale, ink, thickness,
                  cv::LINE_AA);
      x += width + 0.9 * letter;
    }
  }
}

}  // namespace msf
