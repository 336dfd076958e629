// Surfaces of the simulated world: triangles with textures, and the shapes that furniture and
// people are made of.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

namespace msf {

struct Vertex {
  Eigen::Vector3f position;  // m
  Eigen::Vector3f normal;    // unit length, out of the surface
  Eigen::Vector2f uv;        // texture coordinates, 0..1, v down
  float light = 1;           // brightness factor, set by Illuminate
};

// Corners run clockwise for who looks at the front; the back is invisible.
struct Triangle {
  std::array<int, 3> vertices;
  int texture;
};

// A rectangle of a texture.
struct TextureArea {
  int texture = 0;
  Eigen::Vector2f from = {0, 0};  // top left
  Eigen::Vector2f to = {1, 1};    // bottom right
};

// A cross-section of a loft: an ellipse around `center` in the x-y plane of the shape.
struct Ring {
  Eigen::Vector3f center;
  float radius_x;
  float radius_y;
};

struct Mesh {
  std::vector<Vertex> vertices;
  std::vector<Triangle> triangles;

  // A parallelogram with the picture's top left corner at `corner`, seen from the side where
  // `right` points right and `down` points down. Split into cells of at most `cell_m` so that light
  // can vary over it.
  void AddPatch(const Eigen::Vector3f& corner, const Eigen::Vector3f& right,
                const Eigen::Vector3f& down, const TextureArea& area, float cell_m = 0.7f);

  // Faces of a box in the order of AddBox: front (-y), back (+y), left (-x), right (+x), top (+z),
  // bottom (-z).
  using BoxFaces = std::array<TextureArea, 6>;
  void AddBox(const Eigen::Vector3f& low, const Eigen::Vector3f& high, const BoxFaces& faces);
  void AddBox(const Eigen::Vector3f& low, const Eigen::Vector3f& high,
              const TextureArea& all_faces);

  // A closed skin over rings that are listed from the low to the high end (z rises); u runs around,
  // v from the top down.
  void AddLoft(const std::vector<Ring>& rings, const TextureArea& area, int segments = 14);
  void AddSphere(const Eigen::Vector3f& center, float radius, const TextureArea& area,
                 int segments = 18);
  void AddCylinder(const Eigen::Vector3f& foot, float radius, float height, const TextureArea& side,
                   const TextureArea& top, int segments = 18);

  // Adds `other`, moved by `pose`.
  void Append(const Mesh& other, const Eigen::Isometry3f& pose);
};

// A lamp without falloff to zero and without shadows: enough for plausible shading.
struct Light {
  Eigen::Vector3f position;
  float strength;
};

// Sets Vertex::light of vertices [first, end): ambient light plus Lambert's law for every lamp.
void Illuminate(const std::vector<Light>& lights, Mesh& mesh, size_t first = 0);

}  // namespace msf
