#include "flow/point_flow.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace msf {
namespace {

// Smooth random texture, moved by (dx, dy) px.
cv::Mat Texture(float dx, float dy, double blur_px = 4) {
  cv::Mat noise(480, 640, CV_8U);
  cv::RNG random(7);
  random.fill(noise, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(noise, noise, {}, blur_px);
  cv::normalize(noise, noise, 0, 255, cv::NORM_MINMAX);
  const cv::Matx23f shift(1, 0, dx, 0, 1, dy);
  cv::Mat moved;
  cv::warpAffine(noise, moved, shift, noise.size());
  return moved;
}

std::vector<Eigen::Vector2f> Grid() {
  std::vector<Eigen::Vector2f> points;
  for (int y = 80; y < 400; y += 40) {
    for (int x = 80; x < 560; x += 40)
      points.emplace_back(static_cast<float>(x), static_cast<float>(y));
  }
  return points;
}

void ExpectFollows(const FlowOptions& options, float dx, float dy,
                   const std::vector<Eigen::Vector2f>& guesses, double blur_px = 4) {
  const FlowImage from(Texture(0, 0, blur_px), options), to(Texture(dx, dy, blur_px), options);
  const std::vector<Eigen::Vector2f> points = Grid();
  const std::vector<FlowPoint> flow = FollowPoints(from, to, points, guesses, options);
  // A small window may find the wrong thing now and then.
  int followed = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2f error_px = flow[i].image_px - points[i] - Eigen::Vector2f(dx, dy);
    followed += flow[i].found && error_px.norm() < 0.3f;
  }
  EXPECT_GE(followed, 0.95 * static_cast<double>(points.size()));
}

TEST(PointFlow, FollowsAShift) { ExpectFollows({}, 5.4f, -3.2f, {}); }

TEST(PointFlow, FollowsInTheFullImageWithTheWindowOfThePaper) {
  ExpectFollows({.shrink = 1, .window_px = 5, .iterations = 20}, 2.3f, 1.1f, {}, 2);
}

TEST(PointFlow, AGuessReachesFarther) {
  std::vector<Eigen::Vector2f> guesses = Grid();
  for (Eigen::Vector2f& guess : guesses) guess += Eigen::Vector2f(42, 31);
  ExpectFollows({}, 40, 30, guesses);
}

TEST(PointFlow, WhatLeftTheImageIsNotFound) {
  const FlowOptions options;
  const FlowImage from(Texture(0, 0), options), to(Texture(-60, 0), options);
  const std::vector<Eigen::Vector2f> points = {{20, 200}}, guesses = {{-40, 200}};
  EXPECT_FALSE(FollowPoints(from, to, points, guesses, options)[0].found);
}

TEST(FlowOptions, WhatWouldTakeForeverIsRefused) {
  EXPECT_TRUE((FlowOptions{.window_px = 101, .levels = 8}.Check().ok()));
  EXPECT_FALSE(FlowOptions{.window_px = 102}.Check().ok());
  EXPECT_FALSE(FlowOptions{.levels = 9}.Check().ok());
  EXPECT_FALSE(FlowOptions{.levels = -1}.Check().ok());
}

TEST(PointFlow, NoImageBefore) {
  const FlowOptions options;
  const std::vector<Eigen::Vector2f> points = {{20, 200}};
  EXPECT_FALSE(FollowPoints({}, FlowImage(Texture(0, 0), options), points, {}, options)[0].found);
}

}  // namespace
}  // namespace msf
