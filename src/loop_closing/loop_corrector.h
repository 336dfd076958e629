// Closes a recognised loop: bends the map so that both ends meet, and makes the two passes one.
#pragma once

#include <optional>

#include "loop_closing/loop_closing_options.h"
#include "loop_closing/recognition.h"
#include "map/shared_map.h"

namespace msf {

// How many duplicates went, or nothing when the loop could not be closed: its keyframes are gone,
// or other corrections kept coming first.
std::optional<int> CloseLoop(const LoopClosingOptions& options, const Recognition& loop,
                             SharedMap& map);

}  // namespace msf
