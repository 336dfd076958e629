// What a frame shows of the part of the map that can be relied on to stand still.
#pragma once

#include <span>
#include <vector>

#include "feature/landmark.h"
#include "tracking/pose_tracking.h"

namespace msf {

// Among `matches`, map points that are likely to be static and have been known for a while (see
// TrackingOptions::landmark_age_s): what people carried into the map is younger, or doubted by now.
// `extracted`: the features as the image shows them, a rolling shutter not undone. At most
// `TrackingOptions::max_landmarks`, evenly chosen.
std::vector<Landmark> FindLandmarks(const TrackingContext& context, const Map& map,
                                    const Frame& frame, const FrameFeatures& extracted,
                                    std::span<const PointMatch> matches);

}  // namespace msf
