#include "simulation/world.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "simulation/furniture.h"
#include "simulation/painter.h"

namespace msf {
namespace {

constexpr float kHeight = 2.6f;
constexpr float kTexel_mm = 5;
constexpr float kDoorHeight = 2.1f;
constexpr float kWallThickness = 0.15f;

struct Room {
  Eigen::Vector2f low, high;
  Wall north, east, south, west;
};

Room MakeRoom(const Eigen::Vector2f& low, const Eigen::Vector2f& high) {
  const Eigen::Vector2f north_west(low.x(), high.y()), south_east(high.x(), low.y());
  return {low,
          high,
          {north_west, high, kHeight},
          {high, south_east, kHeight},
          {south_east, low, kHeight},
          {low, north_west, kHeight}};
}

// The doorways between the rooms, south and north, as ranges of y.
constexpr float kDoors[2][2] = {{0.9f, 2.1f}, {3.9f, 5.1f}};

std::vector<Opening> DoorwaysOf(const Wall& wall) {
  std::vector<Opening> openings;
  for (const auto& door : kDoors) {
    const bool northwards = wall.right.y() > wall.left.y();
    const float begin = northwards ? door[0] - wall.left.y() : wall.left.y() - door[1];
    openings.push_back({begin, begin + door[1] - door[0], kDoorHeight});
  }
  if (openings[0].begin > openings[1].begin) std::swap(openings[0], openings[1]);
  return openings;
}

using WallPainter = cv::Mat (*)(cv::Size, const cv::Scalar&, Random);

void AddWalls(SceneBuilder& builder, const Room& room, WallPainter paint, const cv::Scalar& base,
              const std::vector<Opening>& east, const std::vector<Opening>& west) {
  const auto add = [&](const Wall& wall, const std::vector<Opening>& openings) {
    const cv::Size size = SceneBuilder::Texels(wall.length(), wall.height, kTexel_mm);
    builder.AddWall(wall, openings, builder.AddTexture(paint(size, base, builder.NextRandom())));
  };
  add(room.north, {});
  add(room.east, east);
  add(room.south, {});
  add(room.west, west);
  const Eigen::Vector2f size = room.high - room.low;
  const TextureArea ceiling = builder.AddTexture(PaintCeilingPanels(
      SceneBuilder::Texels(size.x(), size.y(), 2 * kTexel_mm), builder.NextRandom()));
  builder.AddPatch({room.low.x(), room.low.y(), kHeight}, {size.x(), 0, 0}, {0, size.y(), 0},
                   ceiling);
}

// Pictures along a wall between `begin` and `end` metres, one about every `pitch` metres.
void HangPictures(SceneBuilder& builder, const Wall& wall, float begin, float end, float pitch,
                  float up) {
  Random random = builder.NextRandom();
  const int count = static_cast<int>((end - begin) / pitch + 1e-3f);
  for (int i = 0; i < count; ++i) {
    const float along = begin + (static_cast<float>(i) + 0.5f) * pitch;
    const bool tall = random.Chance(0.5);
    const float width = static_cast<float>(random.Uniform(0.6, 0.8)) * pitch * (tall ? 0.75f : 1);
    const float height = width * (tall ? 1.4f : 0.72f);
    const TextureArea area = builder.AddTexture(
        PaintPoster(SceneBuilder::Texels(width, height, 2), random.Fork(random.Next())));
    builder.Hang(wall, along, up + static_cast<float>(random.Uniform(-0.12, 0.12)), {width, height},
                 area);
  }
}

// Small notes, switches and signs scattered over the free part of a wall.
void HangNotes(SceneBuilder& builder, const Wall& wall, float begin, float end, int count) {
  Random random = builder.NextRandom();
  for (int i = 0; i < count; ++i) {
    const float along =
        begin + (end - begin) * (static_cast<float>(i) + 0.5f) / static_cast<float>(count);
    const float size = static_cast<float>(random.Uniform(0.1, 0.22));
    const TextureArea area = builder.AddTexture(
        PaintPage(SceneBuilder::Texels(size, size * 1.3f, 1.5f), random.Fork(i)));
    const float up = static_cast<float>(random.Chance(0.5) ? random.Uniform(0.45, 0.9)
                                                           : random.Uniform(1.95, 2.2));
    builder.Hang(wall, along, up, {size, size * 1.3f}, area);
  }
}

void HangDoor(SceneBuilder& builder, const Wall& wall, float along) {
  Random random = builder.NextRandom();
  const TextureArea area = builder.AddTexture(
      PaintDoor(SceneBuilder::Texels(1.0f, kDoorHeight, 3), {120, 150, 165}, random));
  builder.Hang(wall, along, kDoorHeight / 2, {1.0f, kDoorHeight}, area);
}

void HangWindow(SceneBuilder& builder, const Wall& wall, float along) {
  const TextureArea view = builder.AddTexture(
      PaintLandscape(SceneBuilder::Texels(1.4f, 1.1f, 2.5f), builder.NextRandom()));
  builder.Hang(wall, along, 1.55f, {1.4f, 1.1f}, view);
}

void AddRug(SceneBuilder& builder, float x, float y, float width, float depth) {
  const TextureArea rug =
      builder.AddTexture(PaintRug(SceneBuilder::Texels(width, depth, 4), builder.NextRandom()));
  builder.AddPatch({x - width / 2, y + depth / 2, 0.01f}, {width, 0, 0}, {0, -depth, 0}, rug);
}

void FurnishOffice(SceneBuilder& builder, const Room& room) {
  builder.Place(MakeDesk(builder, 1.8f, 0.9f, 0.74f), {3.1f, 3.0f, 0});
  builder.Place(MakeDeskClutter(builder, 1.7f, 0.8f), {3.1f, 3.0f, 0.74f});
  builder.Place(MakeChair(builder), {1.75f, 3.0f, 0}, 90);
  builder.Place(MakeChair(builder), {4.45f, 3.0f, 0}, -90);
  builder.Place(MakeShelf(builder, 1.6f, 0.32f, 2.0f), {1.0f, 5.8f, 0});
  builder.Place(MakeCabinet(builder, 1.2f, 0.45f, 1.1f), {2.6f, 5.75f, 0});
  builder.Place(MakeShelf(builder, 1.4f, 0.32f, 2.0f), {4.3f, 5.8f, 0});
  builder.Place(MakeBooks(builder, 5), {2.3f, 5.75f, 1.1f}, 20);
  builder.Place(MakePlant(builder, 0.5f), {2.8f, 5.75f, 1.1f});
  builder.Place(MakePlant(builder, 1.3f), {5.5f, 5.55f, 0});
  builder.Place(MakeCabinet(builder, 1.6f, 0.45f, 0.9f), {0.3f, 3.6f, 0}, 90);
  builder.Place(MakeDeskClutter(builder, 1.2f, 0.4f), {0.3f, 3.6f, 0.9f}, 90);
  builder.Place(MakeShelf(builder, 1.2f, 0.32f, 1.6f), {0.2f, 1.4f, 0}, 90);
  builder.Place(MakeDesk(builder, 1.4f, 0.55f, 0.74f), {2.2f, 0.35f, 0}, 180);
  builder.Place(MakeDeskClutter(builder, 1.3f, 0.5f), {2.2f, 0.35f, 0.74f}, 180);
  builder.Place(MakeCarton(builder, 0.5f, 0.4f, 0.35f), {3.5f, 0.35f, 0}, 170);
  builder.Place(MakeCarton(builder, 0.4f, 0.32f, 0.3f), {3.5f, 0.37f, 0.35f}, 195);
  builder.Place(MakeCabinet(builder, 0.9f, 0.45f, 1.3f), {4.6f, 0.28f, 0}, 180);
  builder.Place(MakeCabinet(builder, 0.8f, 0.3f, 0.8f), {5.82f, 3.0f, 0}, -90);
  builder.Place(MakeBooks(builder, 4), {5.82f, 3.1f, 0.8f}, -80);
  HangPictures(builder, room.north, 1.9f, 3.5f, 0.8f, 1.75f);
  HangPictures(builder, room.west, 0.3f, 2.2f, 0.7f, 1.95f);
  HangWindow(builder, room.west, 3.7f);
  HangPictures(builder, room.west, 4.6f, 5.8f, 0.7f, 1.5f);
  HangPictures(builder, room.south, 0.2f, 5.8f, 0.8f, 1.7f);
  HangPictures(builder, room.east, 2.2f, 3.8f, 0.7f, 1.55f);  // between the doors
  HangPictures(builder, room.east, 5.2f, 5.9f, 0.6f, 1.5f);
  for (const Wall* wall : {&room.north, &room.south, &room.west})
    HangNotes(builder, *wall, 0.2f, 5.8f, 7);
  HangNotes(builder, room.east, 2.2f, 3.8f, 3);
  AddRug(builder, 1.3f, 4.9f, 1.8f, 0.9f);
  const Eigen::Vector2f size = room.high - room.low;
  builder.AddFloor(
      room.low, room.high,
      PaintParquet(SceneBuilder::Texels(size.x(), size.y(), kTexel_mm), builder.NextRandom()));
}

void FurnishLivingRoom(SceneBuilder& builder, const Room& room) {
  const float x0 = room.low.x();
  builder.Place(MakeSofa(builder, 1.9f), {x0 + 2.5f, 3.35f, 0});
  builder.Place(MakeDesk(builder, 1.1f, 0.6f, 0.45f), {x0 + 2.5f, 2.5f, 0});
  builder.Place(MakeBooks(builder, 4), {x0 + 2.3f, 2.5f, 0.45f}, 30);
  builder.Place(MakeMug(builder), {x0 + 2.75f, 2.4f, 0.45f});
  builder.Place(MakePlant(builder, 0.35f), {x0 + 2.6f, 2.6f, 0.45f});
  builder.Place(MakeFloorLamp(builder), {x0 + 0.95f, 3.55f, 0});
  builder.Place(MakeShelf(builder, 1.4f, 0.35f, 2.1f), {room.high.x() - 0.2f, 2.0f, 0}, -90);
  builder.Place(MakeCabinet(builder, 1.5f, 0.45f, 0.8f), {room.high.x() - 0.25f, 4.1f, 0}, -90);
  builder.Place(MakeMonitor(builder), {room.high.x() - 0.25f, 4.1f, 0.8f}, -90);
  builder.Place(MakePlant(builder, 1.5f), {room.high.x() - 0.5f, 0.5f, 0});
  builder.Place(MakePlant(builder, 1.2f), {room.high.x() - 0.5f, 5.5f, 0});
  builder.Place(MakeCabinet(builder, 1.3f, 0.45f, 1.2f), {x0 + 1.3f, 0.27f, 0}, 180);
  builder.Place(MakeBooks(builder, 6), {x0 + 1.3f, 0.27f, 1.2f}, 170);
  builder.Place(MakeShelf(builder, 1.5f, 0.35f, 1.7f), {x0 + 3.2f, 0.22f, 0}, 180);
  builder.Place(MakeShelf(builder, 1.2f, 0.35f, 2.1f), {x0 + 1.2f, 5.8f, 0});
  builder.Place(MakeCabinet(builder, 1.6f, 0.45f, 0.9f), {x0 + 3.1f, 5.75f, 0});
  builder.Place(MakeBall(builder, 0.2f), {x0 + 3.1f, 5.7f, 0.9f});
  builder.Place(MakeChair(builder), {x0 + 0.5f, 3.0f, 0}, 90);
  builder.Place(MakeBall(builder, 0.18f), {x0 + 0.5f, 2.5f, 0});
  HangPictures(builder, room.north, 2.1f, 5.0f, 0.95f, 1.7f);
  HangPictures(builder, room.south, 0.3f, 4.9f, 0.9f, 1.9f);
  HangPictures(builder, room.east, 0.3f, 5.7f, 0.9f, 1.75f);
  HangPictures(builder, room.west, 2.2f, 3.8f, 0.75f, 1.6f);
  HangPictures(builder, room.west, 0.1f, 0.8f, 0.6f, 1.6f);
  AddRug(builder, x0 + 2.5f, 2.4f, 2.4f, 1.5f);
  const Eigen::Vector2f size = room.high - room.low;
  builder.AddFloor(room.low, room.high,
                   PaintCarpet(SceneBuilder::Texels(size.x(), size.y(), kTexel_mm), {92, 84, 70},
                               builder.NextRandom()));
}

// The thickness of the wall in the doorways.
void AddDoorFrames(SceneBuilder& builder, float x0, float x1) {
  for (const auto& door : kDoors) {
    const TextureArea wood =
        builder.AddTexture(PaintWood(SceneBuilder::Texels(kDoorHeight, kWallThickness, 2),
                                     {110, 145, 170}, builder.NextRandom()));
    const float width = door[1] - door[0], depth = x1 - x0;
    builder.AddPatch({x0, door[1], kDoorHeight}, {depth, 0, 0}, {0, 0, -kDoorHeight}, wood);
    builder.AddPatch({x1, door[0], kDoorHeight}, {-depth, 0, 0}, {0, 0, -kDoorHeight}, wood);
    builder.AddPatch({x0, door[0], kDoorHeight}, {depth, 0, 0}, {0, width, 0}, wood);
    builder.AddPatch({x0, door[1], 0}, {depth, 0, 0}, {0, -width, 0}, wood);
  }
}

SceneBuilder BuildOffice(uint64_t seed, bool with_living_room) {
  SceneBuilder builder(seed);
  builder.AddLight({{1.8f, 1.8f, 2.5f}, 0.65f});
  builder.AddLight({{4.2f, 4.2f, 2.5f}, 0.65f});
  const Room office = MakeRoom({0, 0}, {6, 6});
  const std::vector<Opening> doorways =
      with_living_room ? DoorwaysOf(office.east) : std::vector<Opening>();
  AddWalls(builder, office, PaintPlaster, {196, 208, 212}, doorways, {});
  FurnishOffice(builder, office);
  if (!with_living_room) {
    for (const Opening& opening : DoorwaysOf(office.east))
      HangDoor(builder, office.east, (opening.begin + opening.end) / 2);
    return builder;
  }
  builder.AddLight({{7.8f, 1.8f, 2.5f}, 0.65f});
  builder.AddLight({{9.6f, 4.4f, 2.5f}, 0.65f});
  const Room living_room = MakeRoom({6 + kWallThickness, 0}, {11.2f, 6});
  AddWalls(builder, living_room, PaintWallpaper, {165, 190, 178}, {}, DoorwaysOf(living_room.west));
  AddDoorFrames(builder, office.high.x(), living_room.low.x());
  FurnishLivingRoom(builder, living_room);
  return builder;
}

}  // namespace

std::vector<std::string> WorldNames() { return {"office", "two_rooms"}; }

StatusOr<SceneBuilder> BuildWorld(const std::string& name, uint64_t seed) {
  if (name == "office") return BuildOffice(seed, false);
  if (name == "two_rooms") return BuildOffice(seed, true);
  return Status::Error(
      fmt::format("'{}' is no known world; known are {}", name, fmt::join(WorldNames(), ", ")));
}

}  // namespace msf
