#include "io/ply.h"

#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <ostream>

#include "util/atomic_file.h"

namespace msf {

static_assert(std::endian::native == std::endian::little,
              "WritePly copies numbers as they are in memory");

Status WritePly(const std::filesystem::path& file, const std::vector<PlyPoint>& points) {
  constexpr size_t kVertexBytes = 3 * sizeof(float) + 3;
  return WriteFileAtomically(file, [&](std::ostream& out) {
    out << "ply\nformat binary_little_endian 1.0\ncomment sparse map of MSF-SLAM, metres\n"
        << fmt::format("element vertex {}\n", points.size())
        << "property float x\nproperty float y\nproperty float z\n"
        << "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
    for (const PlyPoint& point : points) {
      std::array<char, kVertexBytes> vertex{};
      std::memcpy(vertex.data(), point.p_w.data(), 3 * sizeof(float));
      std::memcpy(vertex.data() + 3 * sizeof(float), point.rgb.data(), 3);
      out.write(vertex.data(), vertex.size());
    }
  });
}

}  // namespace msf
