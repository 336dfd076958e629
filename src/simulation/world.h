// The places where the simulated camera moves.
#pragma once

#include <string>
#include <vector>

#include "simulation/scene_builder.h"
#include "util/status.h"

namespace msf {

// "office": one closed room of 6 x 6 m with a desk in the middle.
// "two_rooms": that room and a living room east of it, joined by two doorways, so that one can walk
// in a circle. World: x east, y north, z up, metres; the office is [0, 6] x [0, 6]. The same seed
// builds the same world.
// The builder is handed out unfinished, so that more can be put in.
StatusOr<SceneBuilder> BuildWorld(const std::string& name, uint64_t seed);
std::vector<std::string> WorldNames();

}  // namespace msf
