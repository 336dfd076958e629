#include "simulation/renderer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <opencv2/core.hpp>

namespace msf {
namespace {

// log2, good to 0.09: enough to choose a mip level.
float CoarseLog2(float value) {
  const auto bits = std::bit_cast<uint32_t>(std::max(value, 1e-12f));
  return static_cast<float>(bits) * 0x1p-23f - 127.f;
}

// Sharper than the longest side of the pixel's footprint, which blurs surfaces seen at an angle,
// and still free of aliasing thanks to the light blur that bilinear interpolation adds.
constexpr float kLodBias = -0.35f;

// What lookups along a row of one triangle need. Texture coordinates are in texels of the finest
// level.
struct Gradients {
  float iz_x, u_x, v_x, iz_y, u_y, v_y;

  Gradients(const ProjectedTriangle& triangle, float width, float height)
      : iz_x(static_cast<float>(triangle.inverse_depth.a)),
        u_x(static_cast<float>(triangle.u.a) * width),
        v_x(static_cast<float>(triangle.v.a) * height),
        iz_y(static_cast<float>(triangle.inverse_depth.b)),
        u_y(static_cast<float>(triangle.u.b) * width),
        v_y(static_cast<float>(triangle.v.b) * height) {}

  // Level of detail where depth is z and the texture coordinates are (u, v) texels.
  float Lod(float z, float u, float v) const {
    const float u_dx = u_x - u * iz_x, v_dx = v_x - v * iz_x;
    const float u_dy = u_y - u * iz_y, v_dy = v_y - v * iz_y;
    const float along_x = u_dx * u_dx + v_dx * v_dx, along_y = u_dy * u_dy + v_dy * v_dy;
    const float longest = std::max(along_x, along_y), shortest = std::min(along_x, along_y);
    // Geometric mean weighted towards the longer side; squares, hence the half.
    const float squared = 0.7f * CoarseLog2(longest) + 0.3f * CoarseLog2(shortest);
    return 0.5f * squared + CoarseLog2(z) + kLodBias;
  }
};

}  // namespace

Renderer::Renderer(const Scene& scene, const Camera& camera)
    : scene_(scene), camera_(camera), rasterizer_(camera) {}

void Renderer::Render(const Rigid3d& T_cw, const std::vector<PlacedMesh>& movers, bool color_only,
                      RenderedView& view) {
  rasterizer_.Clear(T_cw);
  rasterizer_.Draw(scene_.mesh, 0);
  for (const PlacedMesh& mover : movers) rasterizer_.Draw(mover.mesh, mover.label);

  view.color.create(camera_.height, camera_.width, CV_32FC4);
  if (!color_only) {
    view.depth_m.create(camera_.height, camera_.width, CV_32FC1);
    view.cosine.create(camera_.height, camera_.width, CV_32FC1);
    view.label.create(camera_.height, camera_.width, CV_8UC1);
  }
  for (int row = 0; row < camera_.height; ++row) {
    ShadeRow(row, view);
    if (!color_only) MeasureRow(row, view);
  }
}

void Renderer::ShadeRow(int row, RenderedView& view) const {
  const int* upper = rasterizer_.TriangleRow(2 * row);
  const int* lower = rasterizer_.TriangleRow(2 * row + 1);
  auto* colors = reinterpret_cast<Color4f*>(view.color.ptr(row));
  const auto pure = [&](int x, int index) {
    return upper[2 * x] == index && upper[2 * x + 1] == index && lower[2 * x] == index &&
           lower[2 * x + 1] == index;
  };
  for (int x = 0; x < camera_.width;) {
    const int index = upper[2 * x];
    int end = x;
    while (end < camera_.width && pure(end, index)) ++end;
    if (end == x) {
      colors[x] = ShadeMixed(upper, lower, x, row);
      ++x;
      continue;
    }
    if (index < 0)
      std::fill(colors + x, colors + end, Color4f{});
    else
      ShadeRun(rasterizer_.triangles()[index], x, end, row, colors);
    x = end;
  }
}

void Renderer::ShadeRun(const ProjectedTriangle& triangle, int begin, int end, int row,
                        Color4f* colors) const {
  const Texture& texture = scene_.textures[triangle.texture];
  const float width = static_cast<float>(texture.width()),
              height = static_cast<float>(texture.height());
  const Gradients gradients(triangle, width, height);
  // Start values in double: near the horizon they are small differences of large numbers.
  const float iz0 = static_cast<float>(triangle.inverse_depth.At(begin, row));
  const float u0 = static_cast<float>(triangle.u.At(begin, row));
  const float v0 = static_cast<float>(triangle.v.At(begin, row));
  const float light0 = static_cast<float>(triangle.light.At(begin, row));
  const float u_step = static_cast<float>(triangle.u.a), v_step = static_cast<float>(triangle.v.a);
  const float light_step = static_cast<float>(triangle.light.a);
  float lod = 0;
  for (int x = begin; x < end; ++x) {
    const float t = static_cast<float>(x - begin);
    const float z = 1 / (iz0 + t * gradients.iz_x);
    const float u = (u0 + t * u_step) * z, v = (v0 + t * v_step) * z;
    if ((x - begin) % 4 == 0) lod = gradients.Lod(z, u * width, v * height);  // it changes slowly
    colors[x] = texture.Sample(u, v, lod) * ((light0 + t * light_step) * z);
  }
}

Color4f Renderer::Shade(const ProjectedTriangle& triangle, double x, double y) const {
  const Texture& texture = scene_.textures[triangle.texture];
  const float width = static_cast<float>(texture.width()),
              height = static_cast<float>(texture.height());
  const double z = 1 / triangle.inverse_depth.At(x, y);
  const float u = static_cast<float>(triangle.u.At(x, y) * z),
              v = static_cast<float>(triangle.v.At(x, y) * z);
  const float lod =
      Gradients(triangle, width, height).Lod(static_cast<float>(z), u * width, v * height);
  return texture.Sample(u, v, lod) * static_cast<float>(triangle.light.At(x, y) * z);
}

Color4f Renderer::ShadeMixed(const int* upper, const int* lower, int column, int row) const {
  const int indices[4] = {upper[2 * column], upper[2 * column + 1], lower[2 * column],
                          lower[2 * column + 1]};
  Color4f sum = {};
  bool done[4] = {};
  for (int i = 0; i < 4; ++i) {
    if (done[i] || indices[i] < 0) continue;
    // Once for all samples of a triangle, in their middle.
    int count = 0;
    double x = 0, y = 0;
    for (int j = i; j < 4; ++j) {
      if (indices[j] != indices[i]) continue;
      done[j] = true;
      ++count;
      x += Rasterizer::SamplePosition(2 * column + j % 2);
      y += Rasterizer::SamplePosition(2 * row + j / 2);
    }
    const ProjectedTriangle& triangle = rasterizer_.triangles()[indices[i]];
    sum += Shade(triangle, x / count, y / count) * (0.25f * static_cast<float>(count));
  }
  return sum;
}

void Renderer::MeasureRow(int row, RenderedView& view) const {
  const int* upper = rasterizer_.TriangleRow(2 * row);
  const float* inverse_depths = rasterizer_.InverseDepthRow(2 * row);
  float* depth = view.depth_m.ptr<float>(row);
  float* cosine = view.cosine.ptr<float>(row);
  uint8_t* label = view.label.ptr<uint8_t>(row);
  const double ray_y = (row - camera_.cy) / camera_.fy;
  for (int x = 0; x < camera_.width; ++x) {
    // The upper left sample stands for the pixel; on a border any of the four would be as good.
    const int index = upper[2 * x];
    if (index < 0) {
      depth[x] = cosine[x] = 0;
      label[x] = 0;
      continue;
    }
    const ProjectedTriangle& triangle = rasterizer_.triangles()[index];
    const float at_sample = inverse_depths[2 * x];
    const float at_center = static_cast<float>(triangle.inverse_depth.At(x, row));
    // A surface seen almost edge-on may not reach the pixel's centre at a sensible depth.
    const bool continued = std::abs(at_center - at_sample) < 0.02f * at_sample;
    const float inverse_depth = continued ? at_center : at_sample;
    const double ray_x = (x - camera_.cx) / camera_.fx;
    const float ray_length = static_cast<float>(std::sqrt(ray_x * ray_x + ray_y * ray_y + 1));
    depth[x] = 1 / inverse_depth;
    cosine[x] = static_cast<float>(triangle.distance_m) * inverse_depth / ray_length;
    label[x] = static_cast<uint8_t>(triangle.label);
  }
}

}  // namespace msf
