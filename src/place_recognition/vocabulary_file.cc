#include "place_recognition/vocabulary_file.h"

#include <fmt/format.h>

#include <bit>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string_view>

#include "util/atomic_file.h"

namespace msf {
namespace {

static_assert(std::endian::native == std::endian::little,
              "the vocabulary file is read as it lies in memory");

constexpr std::string_view kMagic = "MSFVOCAB";
constexpr uint32_t kVersion = 1;
constexpr uint32_t kMaxNodes = 100'000'000;

struct Header {
  char magic[8];
  uint32_t version;
  uint32_t branching;
  uint32_t levels;
  uint32_t num_nodes;
  uint64_t checksum;
  uint64_t reserved[2];
};
static_assert(sizeof(Header) == 48);

// The parts after the header as offsets into 64-bit units.
struct Layout {
  size_t first_child, weights, end;
  explicit Layout(size_t nodes)
      : first_child(4 * nodes),
        weights(first_child + (nodes + 1 + 1) / 2),
        end(weights + (nodes + 1) / 2) {}
};

// FNV-1a over 64-bit units, with a shift that lets high bits reach low ones.
uint64_t Checksum(const std::vector<uint64_t>& units) {
  uint64_t hash = 0xcbf29ce484222325u;
  for (const uint64_t unit : units) {
    hash = (hash ^ unit) * 0x100000001b3u;
    hash ^= hash >> 29;
  }
  return hash;
}

Status CheckHeader(const Header& header, const std::string& name) {
  if (std::string_view(header.magic, sizeof(header.magic)) != kMagic) {
    return Status::Error(name +
                         ": is no vocabulary of MSF-SLAM; make one with msf-slam train-vocabulary");
  }
  if (header.version != kVersion) {
    return Status::Error(
        fmt::format("{}: is a vocabulary of version {} where this program reads version {}", name,
                    header.version, kVersion));
  }
  if (header.num_nodes < 1 || header.num_nodes > kMaxNodes) {
    return Status::Error(fmt::format("{}: is damaged: {} nodes", name, header.num_nodes));
  }
  return Status::Ok();
}

}  // namespace

StatusOr<VocabularyTree> ReadVocabularyFile(const std::filesystem::path& file) {
  errno = 0;
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  if (!stream) {
    return Status::Error(fmt::format("{}: cannot be opened: {}", file.string(),
                                     std::strerror(errno != 0 ? errno : ENOENT)));
  }
  const auto file_size = static_cast<uint64_t>(stream.tellg());
  stream.seekg(0);
  Header header{};
  stream.read(reinterpret_cast<char*>(&header), sizeof(header));
  MSF_RETURN_IF_ERROR(CheckHeader(header, file.string()));
  const Layout layout(header.num_nodes);
  const uint64_t expected_size = sizeof(Header) + layout.end * sizeof(uint64_t);
  if (!stream || file_size != expected_size) {
    return Status::Error(
        fmt::format("{}: has {} bytes where {} are expected; it was cut off or is damaged",
                    file.string(), file_size, expected_size));
  }
  std::vector<uint64_t> units(layout.end);
  stream.read(reinterpret_cast<char*>(units.data()),
              static_cast<std::streamsize>(units.size() * sizeof(uint64_t)));
  if (!stream || Checksum(units) != header.checksum) {
    return Status::Error(file.string() +
                         ": is damaged: the checksum does not agree; get a fresh copy");
  }

  VocabularyTree tree{.branching = header.branching,
                      .levels = header.levels,
                      .centres = {},
                      .first_child = {},
                      .weights = {}};
  tree.centres.resize(header.num_nodes);
  tree.first_child.resize(header.num_nodes + 1);
  tree.weights.resize(header.num_nodes);
  std::memcpy(tree.centres.data(), units.data(), tree.centres.size() * sizeof(Descriptor));
  std::memcpy(tree.first_child.data(), units.data() + layout.first_child,
              tree.first_child.size() * sizeof(uint32_t));
  std::memcpy(tree.weights.data(), units.data() + layout.weights,
              tree.weights.size() * sizeof(float));
  const Status status = tree.Check();
  if (!status.ok()) return Status::Error(file.string() + ": is damaged: " + status.message());
  return tree;
}

Status WriteVocabularyFile(const VocabularyTree& tree, const std::filesystem::path& file) {
  const Layout layout(tree.centres.size());
  std::vector<uint64_t> units(layout.end, 0);
  std::memcpy(units.data(), tree.centres.data(), tree.centres.size() * sizeof(Descriptor));
  std::memcpy(units.data() + layout.first_child, tree.first_child.data(),
              tree.first_child.size() * sizeof(uint32_t));
  std::memcpy(units.data() + layout.weights, tree.weights.data(),
              tree.weights.size() * sizeof(float));
  Header header{.magic = {},
                .version = kVersion,
                .branching = tree.branching,
                .levels = tree.levels,
                .num_nodes = static_cast<uint32_t>(tree.num_nodes()),
                .checksum = Checksum(units),
                .reserved = {}};
  std::memcpy(header.magic, kMagic.data(), kMagic.size());
  return WriteFileAtomically(file, [&](std::ostream& stream) {
    stream.write(reinterpret_cast<const char*>(&header), sizeof(header));
    stream.write(reinterpret_cast<const char*>(units.data()),
                 static_cast<std::streamsize>(units.size() * sizeof(uint64_t)));
  });
}

}  // namespace msf
