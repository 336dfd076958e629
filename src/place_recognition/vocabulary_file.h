// The vocabulary on disk. Little-endian, every part aligned to 8 bytes so that it can be mapped
// into memory:
//
//   header, 48 bytes: "MSFVOCAB", u32 version, u32 branching, u32 levels, u32 nodes, u64 checksum,
//   16 bytes of zero centres:          nodes x 32 bytes first_child:      (nodes + 1) x u32, filled
//   up to 8 bytes weights:          nodes x f32, filled up to 8 bytes
//
// The checksum covers all that follows the header.
#pragma once

#include <filesystem>

#include "place_recognition/vocabulary.h"
#include "util/status.h"

namespace msf {

// Errors name the file and say whether it is missing, foreign, of another version, cut off or
// damaged.
StatusOr<VocabularyTree> ReadVocabularyFile(const std::filesystem::path& file);

Status WriteVocabularyFile(const VocabularyTree& tree, const std::filesystem::path& file);

}  // namespace msf
