// Puts a scene together: rooms, furniture, pictures on the walls.
#pragma once

#include <opencv2/core/types.hpp>
#include <vector>

#include "simulation/random.h"
#include "simulation/renderer.h"

namespace msf {

// A wall seen from inside the room. World: x east, y north, z up, floor at z = 0.
struct Wall {
  Eigen::Vector2f left;   // where its left end stands, m
  Eigen::Vector2f right;  // where its right end stands, m
  float height;

  float length() const { return (right - left).norm(); }
  Eigen::Vector3f Direction() const;  // unit, to the right
  Eigen::Vector3f Normal() const;     // unit, into the room
  // `along` metres from the left end, `up` metres above the floor, `out` metres off the wall.
  Eigen::Vector3f At(float along, float up, float out = 0) const;
};

// A doorway in a wall, from `begin` to `end` metres from its left end.
struct Opening {
  float begin;
  float end;
  float height;
};

class SceneBuilder {
 public:
  explicit SceneBuilder(uint64_t seed) : random_(seed) {}

  // A fresh random stream for the next thing.
  Random NextRandom() { return random_.Fork(++streams_); }
  TextureArea AddTexture(const cv::Mat& picture);
  // Texels for a surface of this size.
  static cv::Size Texels(float width_m, float height_m, float texel_mm);

  void AddLight(const Light& light) { scene_.lights.push_back(light); }
  // Sets `furniture` (front towards -y) down at `foot`, turned left by `yaw_deg`.
  void Place(const Mesh& furniture, const Eigen::Vector3f& foot, float yaw_deg = 0);
  void AddWall(const Wall& wall, const std::vector<Opening>& openings, const TextureArea& area);
  // A thin framed picture whose middle is `along`, `up` metres from the wall's lower left end.
  void Hang(const Wall& wall, float along, float up, cv::Size2f size_m, const TextureArea& area);
  // The floor of [low, high], darkened below everything that was placed on it.
  void AddFloor(const Eigen::Vector2f& low, const Eigen::Vector2f& high, cv::Mat picture);
  void AddPatch(const Eigen::Vector3f& corner, const Eigen::Vector3f& right,
                const Eigen::Vector3f& down, const TextureArea& area) {
    scene_.mesh.AddPatch(corner, right, down, area);
  }

  // Lights everything and hands the scene out.
  Scene Finish() &&;

 private:
  Random random_;
  uint64_t streams_ = 0;
  Scene scene_;
  std::vector<cv::Rect2f> footprints_m_;
};

}  // namespace msf
