#include "simulation/scene_builder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <utility>

namespace msf {

Eigen::Vector3f Wall::Direction() const {
  const Eigen::Vector2f along = (right - left).normalized();
  return {along.x(), along.y(), 0};
}

Eigen::Vector3f Wall::Normal() const {
  // down x right, as for any picture that is seen from its front.
  return (-Eigen::Vector3f::UnitZ()).cross(Direction());
}

Eigen::Vector3f Wall::At(float along, float up, float out) const {
  return Eigen::Vector3f(left.x(), left.y(), up) + along * Direction() + out * Normal();
}

TextureArea SceneBuilder::AddTexture(const cv::Mat& picture) {
  scene_.textures.emplace_back(picture);
  return {.texture = static_cast<int>(scene_.textures.size()) - 1};
}

cv::Size SceneBuilder::Texels(float width_m, float height_m, float texel_mm) {
  const auto texels = [&](float length_m) {
    return std::max(8, static_cast<int>(length_m * 1000 / texel_mm));
  };
  return {texels(width_m), texels(height_m)};
}

void SceneBuilder::Place(const Mesh& furniture, const Eigen::Vector3f& foot, float yaw_deg) {
  Eigen::Isometry3f pose = Eigen::Isometry3f::Identity();
  pose.translate(foot);
  pose.rotate(
      Eigen::AngleAxisf(yaw_deg * std::numbers::pi_v<float> / 180, Eigen::Vector3f::UnitZ()));
  const size_t first = scene_.mesh.vertices.size();
  scene_.mesh.Append(furniture, pose);
  if (foot.z() > 0.01f) return;
  Eigen::Vector2f low = Eigen::Vector2f::Constant(std::numeric_limits<float>::max()), high = -low;
  for (size_t i = first; i < scene_.mesh.vertices.size(); ++i) {
    low = low.cwiseMin(scene_.mesh.vertices[i].position.head<2>());
    high = high.cwiseMax(scene_.mesh.vertices[i].position.head<2>());
  }
  footprints_m_.emplace_back(low.x(), low.y(), high.x() - low.x(), high.y() - low.y());
}

void SceneBuilder::AddWall(const Wall& wall, const std::vector<Opening>& openings,
                           const TextureArea& area) {
  const auto piece = [&](float begin, float end, float bottom, float top) {
    if (end - begin < 1e-3f || top - bottom < 1e-3f) return;
    TextureArea part = area;
    part.from = {begin / wall.length(), 1 - top / wall.height};
    part.to = {end / wall.length(), 1 - bottom / wall.height};
    scene_.mesh.AddPatch(wall.At(begin, top), (end - begin) * wall.Direction(),
                         Eigen::Vector3f(0, 0, bottom - top), part);
  };
  float begin = 0;
  for (const Opening& opening : openings) {
    piece(begin, opening.begin, 0, wall.height);
    piece(opening.begin, opening.end, opening.height, wall.height);
    begin = opening.end;
  }
  piece(begin, wall.length(), 0, wall.height);
}

void SceneBuilder::Hang(const Wall& wall, float along, float up, cv::Size2f size_m,
                        const TextureArea& area) {
  constexpr float kThickness = 0.02f;
  const float left = along - size_m.width / 2, top = up + size_m.height / 2;
  const Eigen::Vector3f right = size_m.width * wall.Direction(), down(0, 0, -size_m.height);
  const Eigen::Vector3f in = -kThickness * wall.Normal();
  const Eigen::Vector3f corner = wall.At(left, top, kThickness);
  TextureArea edge = area;
  edge.to = area.from + 0.02f * (area.to - area.from);
  Mesh& mesh = scene_.mesh;
  mesh.AddPatch(corner, right, down, area);
  mesh.AddPatch(corner + in, -in, down, edge);
  mesh.AddPatch(corner + right, in, down, edge);
  mesh.AddPatch(corner + in, right, -in, edge);
  mesh.AddPatch(corner + down, right, in, edge);
}

void SceneBuilder::AddFloor(const Eigen::Vector2f& low, const Eigen::Vector2f& high,
                            cv::Mat picture) {
  const Eigen::Vector2f size = high - low;
  const float scale_x = static_cast<float>(picture.cols) / size.x();
  const float scale_y = static_cast<float>(picture.rows) / size.y();
  cv::Mat shadow(picture.rows / 8, picture.cols / 8, CV_32FC1, cv::Scalar(1));
  for (const cv::Rect2f& foot : footprints_m_) {
    const cv::Point2f from((foot.x - low.x()) * scale_x / 8,
                           (high.y() - foot.br().y) * scale_y / 8);
    const cv::Rect area(from, cv::Size(static_cast<int>(foot.width * scale_x / 8),
                                       static_cast<int>(foot.height * scale_y / 8)));
    cv::rectangle(shadow, area, 0.5, -1);
  }
  cv::GaussianBlur(shadow, shadow, {0, 0}, 0.08 * scale_x / 8);
  cv::resize(shadow, shadow, picture.size());
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      cv::Vec3b& texel = picture.at<cv::Vec3b>(y, x);
      for (int c = 0; c < 3; ++c)
        texel[c] = static_cast<uint8_t>(static_cast<float>(texel[c]) * shadow.at<float>(y, x));
    }
  }
  AddPatch({low.x(), high.y(), 0}, {size.x(), 0, 0}, {0, -size.y(), 0}, AddTexture(picture));
}

Scene SceneBuilder::Finish() && {
  Illuminate(scene_.lights, scene_.mesh);
  return std::move(scene_);
}

}  // namespace msf
