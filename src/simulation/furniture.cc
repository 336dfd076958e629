#include "simulation/furniture.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>

#include "simulation/painter.h"

namespace msf {
namespace {

const cv::Scalar kOak(96, 140, 186), kWalnut(52, 78, 112), kWhite(214, 218, 220),
    kBlack(42, 42, 44);

TextureArea Wood(SceneBuilder& builder, float width, float height, const cv::Scalar& base) {
  return builder.AddTexture(
      PaintWood(SceneBuilder::Texels(width, height, 2), base, builder.NextRandom()));
}

TextureArea Metal(SceneBuilder& builder, const cv::Scalar& base) {
  return builder.AddTexture(PaintMetal({64, 64}, base, builder.NextRandom()));
}

Eigen::Isometry3f At(float x, float y, float z, float yaw_deg = 0) {
  Eigen::Isometry3f pose = Eigen::Isometry3f::Identity();
  pose.translate(Eigen::Vector3f(x, y, z));
  pose.rotate(
      Eigen::AngleAxisf(yaw_deg * std::numbers::pi_v<float> / 180, Eigen::Vector3f::UnitZ()));
  return pose;
}

void AddLegs(Mesh& mesh, float width, float depth, float height, float thickness,
             const TextureArea& area) {
  const float x = width / 2 - thickness, y = depth / 2 - thickness;
  for (const float side : {-1.f, 1.f}) {
    for (const float end : {-1.f, 1.f}) {
      const Eigen::Vector3f middle(side * x, end * y, 0), half(thickness / 2, thickness / 2, 0);
      mesh.AddBox(middle - half, middle + half + Eigen::Vector3f(0, 0, height), area);
    }
  }
}

// Books of different sizes side by side on a board, from `left` to `right`, their backs at y =
// `front`.
void AddBookRow(SceneBuilder& builder, Mesh& mesh, float left, float right, float front, float z,
                float tallest) {
  Random random = builder.NextRandom();
  float x = left;
  while (true) {
    const float width = static_cast<float>(random.Uniform(0.02, 0.055));
    if (x + width > right) return;
    const float height = tallest * static_cast<float>(random.Uniform(0.65, 0.95));
    const float inset = static_cast<float>(random.Uniform(0, 0.035));
    const TextureArea spine = builder.AddTexture(
        PaintBookSpine(SceneBuilder::Texels(width, height, 1.6f), random.Fork(random.Next())));
    mesh.AddBox({x, front + inset, z}, {x + width, front + inset + 0.16f, z + height}, spine);
    x += width + (random.Chance(0.08) ? 0.06f : 0.001f);
  }
}

}  // namespace

Mesh MakeDesk(SceneBuilder& builder, float width, float depth, float height) {
  Mesh mesh;
  const TextureArea top = Wood(builder, width, depth, kOak), leg = Metal(builder, kBlack);
  mesh.AddBox({-width / 2, -depth / 2, height - 0.03f}, {width / 2, depth / 2, height}, top);
  AddLegs(mesh, width, depth, height - 0.03f, 0.05f, leg);
  // A drawer unit below one end.
  const TextureArea front = builder.AddTexture(
      PaintCabinetFront(SceneBuilder::Texels(0.4f, 0.55f, 2), kWhite, builder.NextRandom()));
  mesh.AddBox({width / 2 - 0.5f, -depth / 2 + 0.06f, 0.02f},
              {width / 2 - 0.1f, depth / 2 - 0.1f, 0.6f}, front);
  return mesh;
}

Mesh MakeShelf(SceneBuilder& builder, float width, float depth, float height) {
  Mesh mesh;
  const float board = 0.025f;
  const TextureArea wood = Wood(builder, width, height, kWalnut);
  const float x = width / 2, y = depth / 2;
  mesh.AddBox({-x, -y, 0}, {-x + board, y, height}, wood);
  mesh.AddBox({x - board, -y, 0}, {x, y, height}, wood);
  mesh.AddBox({-x, y - 0.01f, 0}, {x, y, height}, wood);
  const int compartments = std::max(2, static_cast<int>(height / 0.36f));
  const float pitch = (height - board) / static_cast<float>(compartments);
  Random random = builder.NextRandom();
  for (int i = 0; i <= compartments; ++i) {
    const float z = static_cast<float>(i) * pitch;
    mesh.AddBox({-x, -y, z}, {x, y, z + board}, wood);
    if (i == compartments) break;
    const float split = static_cast<float>(random.Uniform(-0.6, 0.8)) * x;
    AddBookRow(builder, mesh, -x + board, split, -y + 0.02f, z + board, pitch - 0.05f);
    const float room = x - split - 0.06f;
    if (room > 0.12f) {
      const float size = std::min(room, pitch - 0.08f);
      mesh.Append(MakeCarton(builder, size * 0.9f, 0.18f, size * 0.8f),
                  At((split + x) / 2, 0, z + board));
    }
  }
  return mesh;
}

Mesh MakeCabinet(SceneBuilder& builder, float width, float depth, float height) {
  Mesh mesh;
  Random random = builder.NextRandom();
  const cv::Scalar base = NearbyColor(random.Chance(0.5) ? kWhite : kOak, 25, random);
  const TextureArea front = builder.AddTexture(
      PaintCabinetFront(SceneBuilder::Texels(width, height, 2.5f), base, random.Fork(1)));
  const TextureArea side = Wood(builder, depth, height, base),
                    top = Wood(builder, width, depth, base);
  mesh.AddBox({-width / 2, -depth / 2, 0}, {width / 2, depth / 2, height},
              {front, side, side, side, top, top});
  return mesh;
}

Mesh MakeChair(SceneBuilder& builder) {
  Mesh mesh;
  Random random = builder.NextRandom();
  const TextureArea cloth = builder.AddTexture(PaintFabric(
      SceneBuilder::Texels(0.45f, 0.45f, 2.5f), VividColor(random) * 0.8, random.Fork(1)));
  const TextureArea frame = Metal(builder, kBlack);
  mesh.AddBox({-0.22f, -0.22f, 0.41f}, {0.22f, 0.22f, 0.46f}, cloth);
  mesh.AddBox({-0.21f, 0.18f, 0.56f}, {0.21f, 0.22f, 0.92f}, cloth);
  AddLegs(mesh, 0.44f, 0.44f, 0.41f, 0.035f, frame);
  for (const float x : {-0.17f, 0.17f})
    mesh.AddBox({x - 0.015f, 0.19f, 0.46f}, {x + 0.015f, 0.215f, 0.6f}, frame);
  return mesh;
}

Mesh MakeSofa(SceneBuilder& builder, float width) {
  Mesh mesh;
  Random random = builder.NextRandom();
  const TextureArea cloth = builder.AddTexture(PaintFabric(
      SceneBuilder::Texels(width, 0.8f, 2.5f), VividColor(random) * 0.75, random.Fork(1)));
  const float x = width / 2;
  mesh.AddBox({-x, -0.42f, 0.06f}, {x, 0.42f, 0.42f}, cloth);
  mesh.AddBox({-x, 0.2f, 0.42f}, {x, 0.42f, 0.85f}, cloth);
  for (const float side : {-x, x - 0.16f})
    mesh.AddBox({side, -0.42f, 0.42f}, {side + 0.16f, 0.2f, 0.62f}, cloth);
  for (int i = 0; i < 3; ++i) {
    const TextureArea cushion =
        builder.AddTexture(PaintFabric({180, 180}, VividColor(random), random.Fork(10 + i)));
    Mesh pillow;
    pillow.AddBox({-0.2f, -0.06f, 0}, {0.2f, 0.06f, 0.36f}, cushion);
    mesh.Append(pillow, At(-x + 0.45f + static_cast<float>(i) * (width - 0.9f) / 2, 0.08f, 0.42f,
                           static_cast<float>(random.Uniform(-25, 25))));
  }
  return mesh;
}

Mesh MakePlant(SceneBuilder& builder, float height) {
  Mesh mesh;
  Random random = builder.NextRandom();
  const TextureArea pot = builder.AddTexture(PaintBall({160, 80}, random.Fork(1)));
  const TextureArea leaves = builder.AddTexture(PaintLeaves({256, 192}, random.Fork(2)));
  const float r = 0.16f * height;
  mesh.AddLoft({{{0, 0, 0}, 0.6f * r, 0.6f * r}, {{0, 0, 0.25f * height}, r, r}}, pot);
  mesh.AddCylinder({0, 0, 0.2f * height}, 0.9f * r, 0.03f * height, pot, leaves);
  mesh.AddCylinder({0, 0, 0.2f * height}, 0.02f * height, 0.4f * height, leaves, leaves, 8);
  for (int i = 0; i < 9; ++i) {
    const Eigen::Vector3f center(static_cast<float>(random.Uniform(-0.18, 0.18)) * height,
                                 static_cast<float>(random.Uniform(-0.18, 0.18)) * height,
                                 static_cast<float>(random.Uniform(0.45, 0.9)) * height);
    mesh.AddSphere(center, static_cast<float>(random.Uniform(0.08, 0.14)) * height, leaves, 12);
  }
  return mesh;
}

Mesh MakeFloorLamp(SceneBuilder& builder) {
  Mesh mesh;
  Random random = builder.NextRandom();
  const TextureArea metal = Metal(builder, kBlack);
  const TextureArea shade = builder.AddTexture(PaintFabric({256, 96}, {150, 215, 240}, random));
  mesh.AddCylinder({0, 0, 0}, 0.15f, 0.03f, metal, metal);
  mesh.AddCylinder({0, 0, 0.03f}, 0.015f, 1.4f, metal, metal, 8);
  mesh.AddLoft(
      {{{0, 0, 1.35f}, 0.22f, 0.22f}, {{0, 0, 1.65f}, 0.12f, 0.12f}, {{0, 0, 1.651f}, 0, 0}},
      shade);
  return mesh;
}

Mesh MakeMonitor(SceneBuilder& builder) {
  Mesh mesh;
  const TextureArea screen =
      builder.AddTexture(PaintScreen(SceneBuilder::Texels(0.54f, 0.33f, 1), builder.NextRandom()));
  const TextureArea back = builder.AddTexture(PaintCarton({270, 165}, builder.NextRandom()));
  const TextureArea frame = Metal(builder, kBlack);
  mesh.AddBox({-0.27f, -0.02f, 0.1f}, {0.27f, 0.03f, 0.43f},
              {screen, back, frame, frame, frame, frame});
  mesh.AddBox({-0.03f, 0.03f, 0}, {0.03f, 0.06f, 0.25f}, frame);
  mesh.AddBox({-0.13f, -0.06f, 0}, {0.13f, 0.12f, 0.015f}, frame);
  return mesh;
}

Mesh MakeKeyboard(SceneBuilder& builder) {
  Mesh mesh;
  const TextureArea keys = builder.AddTexture(
      PaintKeyboard(SceneBuilder::Texels(0.44f, 0.15f, 1), builder.NextRandom()));
  const TextureArea side = Metal(builder, kBlack);
  mesh.AddBox({-0.22f, -0.075f, 0}, {0.22f, 0.075f, 0.02f}, {side, side, side, side, keys, side});
  return mesh;
}

Mesh MakeBooks(SceneBuilder& builder, int count) {
  Mesh mesh;
  Random random = builder.NextRandom();
  float z = 0;
  for (int i = 0; i < count; ++i) {
    const float width = static_cast<float>(random.Uniform(0.15, 0.22)), depth = width * 1.35f;
    const float height = static_cast<float>(random.Uniform(0.015, 0.045));
    const TextureArea cover = builder.AddTexture(
        PaintBookCover(SceneBuilder::Texels(width, depth, 1.2f), random.Fork(2 * i)));
    cv::Mat spine;
    cv::Mat upright =
        PaintBookSpine(SceneBuilder::Texels(height, width, 1.2f), random.Fork(2 * i + 1));
    cv::rotate(upright, spine, cv::ROTATE_90_COUNTERCLOCKWISE);
    const TextureArea side = builder.AddTexture(spine);
    Mesh book;
    book.AddBox({-width / 2, -depth / 2, 0}, {width / 2, depth / 2, height},
                {side, side, side, side, cover, cover});
    mesh.Append(book, At(0, 0, z, static_cast<float>(random.Uniform(-22, 22))));
    z += height;
  }
  return mesh;
}

Mesh MakeCarton(SceneBuilder& builder, float width, float depth, float height) {
  Mesh mesh;
  Random random = builder.NextRandom();
  const auto face = [&](float w, float h) {
    return builder.AddTexture(
        PaintCarton(SceneBuilder::Texels(w, h, 1.5f), random.Fork(random.Next())));
  };
  const TextureArea front = face(width, height), side = face(depth, height),
                    top = face(width, depth);
  mesh.AddBox({-width / 2, -depth / 2, 0}, {width / 2, depth / 2, height},
              {front, front, side, side, top, top});
  return mesh;
}

Mesh MakeMug(SceneBuilder& builder) {
  Mesh mesh;
  const TextureArea side = builder.AddTexture(PaintBall({200, 80}, builder.NextRandom()));
  const TextureArea top = Metal(builder, {30, 45, 70});
  mesh.AddCylinder({0, 0, 0}, 0.042f, 0.1f, side, top);
  mesh.AddBox({0.04f, -0.008f, 0.025f}, {0.07f, 0.008f, 0.08f}, side);
  return mesh;
}

Mesh MakePaper(SceneBuilder& builder) {
  Mesh mesh;
  const TextureArea page =
      builder.AddTexture(PaintPage(SceneBuilder::Texels(0.21f, 0.297f, 1), builder.NextRandom()));
  TextureArea edge = page;
  edge.to = {0.05f, 0.05f};
  mesh.AddBox({-0.105f, -0.148f, 0}, {0.105f, 0.148f, 0.004f},
              {edge, edge, edge, edge, page, edge});
  return mesh;
}

Mesh MakeBall(SceneBuilder& builder, float radius) {
  Mesh mesh;
  const TextureArea skin = builder.AddTexture(PaintBall({512, 256}, builder.NextRandom()));
  mesh.AddSphere({0, 0, radius}, radius, skin, 24);
  return mesh;
}

Mesh MakeDeskClutter(SceneBuilder& builder, float width, float depth) {
  Mesh mesh;
  Random random = builder.NextRandom();
  const float front = -depth / 2;
  const int places = std::max(2, static_cast<int>(width / 0.4f));
  for (int i = 0; i < places; ++i) {
    const float x = (static_cast<float>(i) + 0.5f) / static_cast<float>(places) * width - width / 2;
    const float turn = static_cast<float>(random.Uniform(-18, 18));
    if (i % 2 == 1) {
      mesh.Append(MakeMonitor(builder), At(x, depth / 2 - 0.2f, 0, turn));
      mesh.Append(MakeKeyboard(builder), At(x, front + 0.22f, 0, turn / 2));
    } else {
      mesh.Append(MakeBooks(builder, random.Int(3, 6)), At(x, depth / 2 - 0.2f, 0, turn));
      mesh.Append(MakePaper(builder), At(x - 0.03f, front + 0.2f, 0, 2 * turn));
      mesh.Append(MakePaper(builder), At(x + 0.08f, front + 0.24f, 0.004f, -turn));
    }
    mesh.Append(MakeMug(builder), At(x + 0.16f, front + 0.36f, 0, turn));
    if (random.Chance(0.6)) {
      const float size = static_cast<float>(random.Uniform(0.08, 0.14));
      mesh.Append(MakeCarton(builder, size, 0.7f * size, 1.5f * size),
                  At(x - 0.19f, front + 0.42f, 0, turn * 2));
    }
  }
  return mesh;
}

}  // namespace msf
