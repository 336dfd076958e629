// Where two passes through one place meet.
#pragma once

#include <optional>
#include <vector>

#include "loop_closing/loop_closing_options.h"
#include "loop_closing/recognition.h"
#include "map/shared_map.h"

namespace msf {

// The keyframes on both sides, best first, as they are before anything is joined.
struct Seam {
  std::vector<KeyFrameId> current;  // the present keyframe and its neighbours
  std::vector<KeyFrameId> matched;  // the matched keyframe and its neighbours
};

// At most options.max_seam_keyframes on either side; keyframes that belong to both sides belong to
// the matched one. Nothing when one of the two centres is gone.
std::optional<Seam> FindSeam(const LoopClosingOptions& options, const Recognition& place,
                             const Map& map);

// Makes one of what both sides have, once they lie where they should; the matched side's points
// stay. The keyframes of the current side become covisible with the matched side. Returns how many
// points were fused or seen anew. Holds the map for one keyframe at a time.
int FuseSeam(const LoopClosingOptions& options, const Recognition& place, const Seam& seam,
             SharedMap& map);

}  // namespace msf
