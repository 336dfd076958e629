// Whether the includes of src/ agree with the layers (src/CMakeLists.txt) and with the rooms'
// DEPENDS (src/ROOM/CMakeLists.txt).
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "io/test_folder.h"

namespace msf {
namespace {

namespace fs = std::filesystem;

constexpr int kSideRoom =
    100;  // above all layers: a side room may look at everything, no layer may look at it
constexpr int kKeepApart = 4;  // the layer whose rooms do not know each other

struct Room {
  int layer = -1;
  std::set<std::string> depends;
};
using Rooms = std::map<std::string, Room>;

// "# L2" and "# side rooms" head the add_subdirectory() lines of src/CMakeLists.txt.
Rooms ReadLayers(const fs::path& source) {
  Rooms rooms;
  std::ifstream stream(source / "CMakeLists.txt");
  int layer = -1;
  for (std::string line; std::getline(stream, line);) {
    std::smatch match;
    if (std::regex_search(line, match, std::regex(R"(^# L(\d)\b)"))) layer = std::stoi(match[1]);
    if (line.starts_with("# side rooms")) layer = kSideRoom;
    if (std::regex_search(line, match, std::regex(R"(^\s*add_subdirectory\((\w+)\))")))
      rooms[match[1]].layer = layer;
  }
  return rooms;
}

std::set<std::string> ReadDepends(const fs::path& room_folder) {
  const std::string text = ReadWholeFile(room_folder / "CMakeLists.txt");
  std::smatch match;
  std::set<std::string> depends;
  if (!std::regex_search(text, match, std::regex(R"(msf_room\(\s*\w+([^)]*)\))"))) return depends;
  std::istringstream words(match[1].str());
  bool in_depends = false;
  for (std::string word; words >> word;) {
    if (std::isupper(static_cast<unsigned char>(word[0])) != 0)
      in_depends = word == "DEPENDS";
    else if (in_depends)
      depends.insert(word);
  }
  return depends;
}

Rooms ReadRooms(const fs::path& source) {
  Rooms rooms = ReadLayers(source);
  for (auto& [name, room] : rooms) room.depends = ReadDepends(source / name);
  return rooms;
}

bool MayDependOn(const Room& room, const Room& other) {
  if (room.layer == kKeepApart && other.layer == kKeepApart) return false;
  return other.layer <= room.layer;
}

// The rooms below `name`, however far; `name` itself is among them only when there is a cycle.
std::set<std::string> Below(const Rooms& rooms, const std::string& name) {
  std::set<std::string> below;
  std::vector<std::string> open = {name};
  while (!open.empty()) {
    const std::string room = open.back();
    open.pop_back();
    for (const std::string& next : rooms.at(room).depends) {
      if (rooms.contains(next) && below.insert(next).second) open.push_back(next);
    }
  }
  return below;
}

std::vector<std::string> FindBadDepends(const Rooms& rooms) {
  std::vector<std::string> bad;
  for (const auto& [name, room] : rooms) {
    if (room.layer < 0) bad.push_back(name + " is in no layer");
    for (const std::string& other : room.depends) {
      if (!rooms.contains(other))
        bad.push_back(fmt::format("{} depends on {}, which is no room", name, other));
      else if (!MayDependOn(room, rooms.at(other)))
        bad.push_back(fmt::format("{} must not depend on {}", name, other));
    }
    if (Below(rooms, name).contains(name)) bad.push_back(name + " depends on itself");
  }
  return bad;
}

bool IsSource(const fs::path& file) {
  return file.extension() == ".h" || file.extension() == ".cc";
}

std::vector<std::string> FindBadIncludes(const fs::path& source, const Rooms& rooms) {
  static const std::regex include(R"(^\s*#\s*include\s*([<"])([^>"]+)[>"])");
  std::vector<std::string> bad;
  for (const auto& [name, room] : rooms) {
    const std::set<std::string> below = Below(rooms, name);
    for (const auto& entry : fs::recursive_directory_iterator(source / name)) {
      if (!IsSource(entry.path())) continue;
      std::ifstream stream(entry.path());
      int number = 0;
      for (std::string line; std::getline(stream, line);) {
        ++number;
        std::smatch match;
        if (!std::regex_search(line, match, include)) continue;
        const std::string target = match[2], first = target.substr(0, target.find('/'));
        const bool has_folder = target.find('/') != std::string::npos;
        const bool own = match[1] == "\"" || (has_folder && rooms.contains(first));
        const bool allowed = own ? first == name || below.contains(first)
                                 : (first != "torch" || name == "training") &&
                                       (!target.ends_with("highgui.hpp") || name == "viewer");
        if (!allowed)
          bad.push_back(entry.path().lexically_relative(source).string() + ":" +
                        std::to_string(number) + " includes " + target);
      }
    }
  }
  return bad;
}

TEST(IncludeDirection, RoomsDependDownwards) {
  const Rooms rooms = ReadRooms(fs::path(MSF_SOURCE_DIR) / "src");
  ASSERT_GT(rooms.size(), 10u);
  EXPECT_THAT(FindBadDepends(rooms), testing::IsEmpty());
}

TEST(IncludeDirection, EveryFolderWithSourcesIsARoom) {
  const fs::path source = fs::path(MSF_SOURCE_DIR) / "src";
  const Rooms rooms = ReadRooms(source);
  for (const auto& entry : fs::recursive_directory_iterator(source)) {
    if (!IsSource(entry.path())) continue;
    EXPECT_TRUE(rooms.contains(entry.path().lexically_relative(source).begin()->string()))
        << entry.path();
  }
}

TEST(IncludeDirection, IncludesAgreeWithDepends) {
  const fs::path source = fs::path(MSF_SOURCE_DIR) / "src";
  EXPECT_THAT(FindBadIncludes(source, ReadRooms(source)), testing::IsEmpty());
}

// The test itself can fail: a small house with every kind of mistake.
TEST(IncludeDirection, MistakesAreFound) {
  const TestFolder folder;
  for (const char* room : {"util", "map", "tracking", "mapping", "io"})
    fs::create_directories(folder / room);
  folder.Write("CMakeLists.txt",
               "# L0\nadd_subdirectory(util)\n# L2\nadd_subdirectory(map)\n# "
               "L4\nadd_subdirectory(tracking)\nadd_subdirectory(mapping)\n"
               "# side rooms\nadd_subdirectory(io)\n");
  folder.Write("util/CMakeLists.txt", "msf_room(util LINK map)\n");
  folder.Write("map/CMakeLists.txt", "msf_room(map DEPENDS util io nothing\n LINK x)\n");
  folder.Write("tracking/CMakeLists.txt", "msf_room(tracking DEPENDS map mapping NOT_INSTALLED)\n");
  folder.Write("mapping/CMakeLists.txt", "msf_room(mapping DEPENDS tracking)\n");
  folder.Write("io/CMakeLists.txt", "msf_room(io DEPENDS util)\n");
  folder.Write("util/a.h",
               "#include <vector>\n#include \"map/map.h\"\n#include \"util/b.h\"\n#include "
               "<torch/torch.h>\n");
  folder.Write("io/a.cc",
               "#include \"util/a.h\"\n  # include \"map/map.h\"\n#include "
               "<opencv2/highgui.hpp>\n#include \"a.h\"\n");
  const Rooms rooms = ReadRooms(folder.path());
  EXPECT_THAT(FindBadDepends(rooms),
              testing::UnorderedElementsAre(
                  "map must not depend on io", "map depends on nothing, which is no room",
                  "tracking must not depend on mapping", "tracking depends on itself",
                  "mapping must not depend on tracking", "mapping depends on itself"));
  EXPECT_THAT(FindBadIncludes(folder.path(), rooms),
              testing::UnorderedElementsAre(
                  "util/a.h:2 includes map/map.h", "util/a.h:4 includes torch/torch.h",
                  "io/a.cc:2 includes map/map.h", "io/a.cc:3 includes opencv2/highgui.hpp",
                  "io/a.cc:4 includes a.h"));
}

}  // namespace
}  // namespace msf
