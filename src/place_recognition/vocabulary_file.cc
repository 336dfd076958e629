#include "place_recognition/vocabulary_file.h"

#include <fmt/format.h>

#include <algorithm>
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

// The bytes that fill a part of the file up to 8.
size_t Padding(size_t num_bytes) { return (8 - num_bytes % 8) % 8; }

template <typename T>
size_t NumBytes(const std::vector<T>& part) {
  return part.size() * sizeof(T);
}

// Over the filled-up parts, one after the other: FNV-1a by 64-bit units, with a shift that lets
// high bits reach low ones.
class Checksum {
 public:
  template <typename T>
  void Add(const std::vector<T>& part) {
    const char* bytes = reinterpret_cast<const char*>(part.data());
    for (size_t at = 0; at < NumBytes(part); at += 8) {
      uint64_t unit = 0;
      std::memcpy(&unit, bytes + at, std::min<size_t>(8, NumBytes(part) - at));
      value_ = (value_ ^ unit) * 0x100000001b3u;
      value_ ^= value_ >> 29;
    }
  }
  uint64_t value() const { return value_; }

 private:
  uint64_t value_ = 0xcbf29ce484222325u;
};

uint64_t ChecksumOf(const VocabularyTree& tree) {
  Checksum checksum;
  checksum.Add(tree.centres);
  checksum.Add(tree.first_child);
  checksum.Add(tree.weights);
  return checksum.value();
}

template <typename T>
void ReadPart(std::istream& stream, size_t size, std::vector<T>& part) {
  part.resize(size);
  stream.read(reinterpret_cast<char*>(part.data()), static_cast<std::streamsize>(NumBytes(part)));
  stream.ignore(static_cast<std::streamsize>(Padding(NumBytes(part))));
}

template <typename T>
void WritePart(std::ostream& stream, const std::vector<T>& part) {
  stream.write(reinterpret_cast<const char*>(part.data()),
               static_cast<std::streamsize>(NumBytes(part)));
  stream.write("\0\0\0\0\0\0\0", static_cast<std::streamsize>(Padding(NumBytes(part))));
}

uint64_t ExpectedFileSize(uint64_t num_nodes) {
  const uint64_t indices = (num_nodes + 1) * sizeof(uint32_t), weights = num_nodes * sizeof(float);
  return sizeof(Header) + num_nodes * sizeof(Descriptor) + indices + Padding(indices) + weights +
         Padding(weights);
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
  const uint64_t expected_size = ExpectedFileSize(header.num_nodes);
  if (!stream || file_size != expected_size) {
    return Status::Error(
        fmt::format("{}: has {} bytes where {} are expected; it was cut off or is damaged",
                    file.string(), file_size, expected_size));
  }
  VocabularyTree tree;
  tree.branching = header.branching;
  tree.levels = header.levels;
  ReadPart(stream, header.num_nodes, tree.centres);
  ReadPart(stream, header.num_nodes + 1, tree.first_child);
  ReadPart(stream, header.num_nodes, tree.weights);
  if (!stream || ChecksumOf(tree) != header.checksum) {
    return Status::Error(file.string() +
                         ": is damaged: the checksum does not agree; get a fresh copy");
  }
  const Status status = tree.Check();
  if (!status.ok()) return Status::Error(file.string() + ": is damaged: " + status.message());
  return tree;
}

Status WriteVocabularyFile(const VocabularyTree& tree, const std::filesystem::path& file) {
  Header header{.magic = {},
                .version = kVersion,
                .branching = tree.branching,
                .levels = tree.levels,
                .num_nodes = static_cast<uint32_t>(tree.num_nodes()),
                .checksum = ChecksumOf(tree),
                .reserved = {}};
  std::memcpy(header.magic, kMagic.data(), kMagic.size());
  return WriteFileAtomically(file, [&](std::ostream& stream) {
    stream.write(reinterpret_cast<const char*>(&header), sizeof(header));
    WritePart(stream, tree.centres);
    WritePart(stream, tree.first_child);
    WritePart(stream, tree.weights);
  });
}

}  // namespace msf
