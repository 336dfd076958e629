#include "simulation/mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace msf {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

Eigen::Vector2f Lerp(const TextureArea& area, float u, float v) {
  const Eigen::Vector2f size = area.to - area.from;
  return area.from + Eigen::Vector2f(u * size.x(), v * size.y());
}

}  // namespace

void Mesh::AddPatch(const Eigen::Vector3f& corner, const Eigen::Vector3f& right,
                    const Eigen::Vector3f& down, const TextureArea& area, float cell_m) {
  const int columns = std::max(1, static_cast<int>(std::ceil(right.norm() / cell_m)));
  const int rows = std::max(1, static_cast<int>(std::ceil(down.norm() / cell_m)));
  const Eigen::Vector3f normal = down.cross(right).normalized();
  const int first = static_cast<int>(vertices.size());
  for (int row = 0; row <= rows; ++row) {
    for (int column = 0; column <= columns; ++column) {
      const float u = static_cast<float>(column) / static_cast<float>(columns);
      const float v = static_cast<float>(row) / static_cast<float>(rows);
      vertices.push_back({corner + u * right + v * down, normal, Lerp(area, u, v)});
    }
  }
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const int top = first + row * (columns + 1) + column, bottom = top + columns + 1;
      triangles.push_back({{top, top + 1, bottom + 1}, area.texture});
      triangles.push_back({{top, bottom + 1, bottom}, area.texture});
    }
  }
}

void Mesh::AddBox(const Eigen::Vector3f& low, const Eigen::Vector3f& high, const BoxFaces& faces) {
  const Eigen::Vector3f size = high - low;
  const Eigen::Vector3f x(size.x(), 0, 0), y(0, size.y(), 0), z(0, 0, size.z());
  const Eigen::Vector3f top = low + z;
  AddPatch(top, x, -z, faces[0]);
  AddPatch(top + y + x, -x, -z, faces[1]);
  AddPatch(top + y, -y, -z, faces[2]);
  AddPatch(top + x, y, -z, faces[3]);
  AddPatch(top + y, x, -y, faces[4]);
  AddPatch(low, x, y, faces[5]);
}

void Mesh::AddBox(const Eigen::Vector3f& low, const Eigen::Vector3f& high,
                  const TextureArea& all_faces) {
  BoxFaces faces;
  faces.fill(all_faces);
  AddBox(low, high, faces);
}

void Mesh::AddLoft(const std::vector<Ring>& rings, const TextureArea& area, int segments) {
  const int first = static_cast<int>(vertices.size());
  const float bottom = rings.front().center.z(), height = rings.back().center.z() - bottom;
  for (size_t i = 0; i < rings.size(); ++i) {
    const Ring& below = rings[i == 0 ? 0 : i - 1];
    const Ring& above = rings[std::min(i + 1, rings.size() - 1)];
    const float rise = std::max(above.center.z() - below.center.z(), 1e-6f);
    const float slope =
        (above.radius_x + above.radius_y - below.radius_x - below.radius_y) / (2 * rise);
    for (int k = 0; k <= segments; ++k) {
      // Starts at the back, so that the middle of the picture (u = 0.5) faces the front (-y).
      const float u = static_cast<float>(k) / static_cast<float>(segments);
      const float angle = 2 * kPi * u + kPi / 2;
      const float c = std::cos(angle), s = std::sin(angle);
      const Eigen::Vector3f position =
          rings[i].center + Eigen::Vector3f(rings[i].radius_x * c, rings[i].radius_y * s, 0);
      const float v = height > 0 ? (rings.back().center.z() - rings[i].center.z()) / height : 0;
      const Eigen::Vector3f normal =
          Eigen::Vector3f(c * rings[i].radius_y + 1e-6f * c, s * rings[i].radius_x + 1e-6f * s, 0)
              .normalized() +
          Eigen::Vector3f(0, 0, std::clamp(-slope, -20.f, 20.f));
      vertices.push_back({position, normal.normalized(), Lerp(area, u, v)});
    }
  }
  for (int i = 0; i + 1 < static_cast<int>(rings.size()); ++i) {
    for (int k = 0; k < segments; ++k) {
      const int low = first + i * (segments + 1) + k, high = low + segments + 1;
      triangles.push_back({{high, high + 1, low + 1}, area.texture});
      triangles.push_back({{high, low + 1, low}, area.texture});
    }
  }
}

void Mesh::AddSphere(const Eigen::Vector3f& center, float radius, const TextureArea& area,
                     int segments) {
  std::vector<Ring> rings;
  const int steps = segments / 2;
  for (int i = 0; i <= steps; ++i) {
    const float angle = kPi * static_cast<float>(i) / static_cast<float>(steps);
    const float ring_radius = radius * std::sin(angle);
    rings.push_back(
        {center + Eigen::Vector3f(0, 0, -radius * std::cos(angle)), ring_radius, ring_radius});
  }
  const size_t first = vertices.size();
  AddLoft(rings, area, segments);
  for (size_t i = first; i < vertices.size(); ++i) {
    vertices[i].normal = (vertices[i].position - center).normalized();
  }
}

void Mesh::AddCylinder(const Eigen::Vector3f& foot, float radius, float height,
                       const TextureArea& side, const TextureArea& top, int segments) {
  const Eigen::Vector3f up(0, 0, height);
  AddLoft({{foot, radius, radius}, {foot + up, radius, radius}}, side, segments);
  const int center = static_cast<int>(vertices.size());
  vertices.push_back({foot + up, Eigen::Vector3f::UnitZ(), Lerp(top, 0.5f, 0.5f)});
  for (int k = 0; k <= segments; ++k) {
    const float angle = 2 * kPi * static_cast<float>(k) / static_cast<float>(segments);
    const Eigen::Vector3f offset(std::cos(angle), std::sin(angle), 0);
    vertices.push_back({foot + up + radius * offset, Eigen::Vector3f::UnitZ(),
                        Lerp(top, 0.5f + 0.5f * offset.x(), 0.5f - 0.5f * offset.y())});
    if (k > 0) triangles.push_back({{center, center + k + 1, center + k}, top.texture});
  }
}

void Mesh::Append(const Mesh& other, const Eigen::Isometry3f& pose) {
  const int first = static_cast<int>(vertices.size());
  for (Vertex vertex : other.vertices) {
    vertex.position = pose * vertex.position;
    vertex.normal = pose.linear() * vertex.normal;
    vertices.push_back(vertex);
  }
  for (Triangle triangle : other.triangles) {
    for (int& index : triangle.vertices) index += first;
    triangles.push_back(triangle);
  }
}

void Illuminate(const std::vector<Light>& lights, Mesh& mesh, size_t first) {
  constexpr float kAmbient = 0.55f;
  for (size_t i = first; i < mesh.vertices.size(); ++i) {
    Vertex& vertex = mesh.vertices[i];
    float sum = kAmbient + 0.06f * vertex.normal.z();
    for (const Light& light : lights) {
      const Eigen::Vector3f to_light = light.position - vertex.position;
      const float squared = to_light.squaredNorm();
      const float cosine = std::max(0.f, vertex.normal.dot(to_light) / std::sqrt(squared + 1e-6f));
      sum += light.strength * cosine / (1 + squared / 8);
    }
    vertex.light = std::min(sum, 1.2f);
  }
}

}  // namespace msf
