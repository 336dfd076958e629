// The course of a training, for people and programs.
#pragma once

#include <filesystem>
#include <vector>

#include "util/status.h"

namespace msf {

struct EpochRecord;

// Writes DIR/curves.csv (one line per epoch) and DIR/curves.svg (losses and mAP over epochs).
Status WriteCurves(const std::filesystem::path& directory, const std::vector<EpochRecord>& records);

}  // namespace msf
