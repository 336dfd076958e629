// A rolling shutter exposes the rows of an image one after the other, so that a moving camera sees
// each from another place.
#pragma once

#include "feature/frame_features.h"
#include "geometry/rigid3d.h"

namespace msf {

// The features where they would be, had all rows been exposed with the middle one. `velocity`: of
// the camera, per second: Exp(velocity * t) takes its coordinates to those t seconds later.
// `features` are as extracted. Points without depth are taken for far away.
FrameFeatures UndoRollingShutter(const FrameFeatures& features, const Camera& camera,
                                 const Vector6d& velocity);

}  // namespace msf
