// Furniture and small things as meshes that stand on z = 0 with their front towards -y, centred on
// the z axis. Metres.
#pragma once

#include "simulation/scene_builder.h"

namespace msf {

Mesh MakeDesk(SceneBuilder& builder, float width, float depth, float height);
Mesh MakeShelf(SceneBuilder& builder, float width, float depth, float height);
Mesh MakeCabinet(SceneBuilder& builder, float width, float depth, float height);
Mesh MakeChair(SceneBuilder& builder);
Mesh MakeSofa(SceneBuilder& builder, float width);
Mesh MakePlant(SceneBuilder& builder, float height);
Mesh MakeFloorLamp(SceneBuilder& builder);

Mesh MakeMonitor(SceneBuilder& builder);
Mesh MakeKeyboard(SceneBuilder& builder);
Mesh MakeBooks(SceneBuilder& builder, int count);
Mesh MakeCarton(SceneBuilder& builder, float width, float depth, float height);
Mesh MakeMug(SceneBuilder& builder);
Mesh MakePaper(SceneBuilder& builder);
Mesh MakeBall(SceneBuilder& builder, float radius);

// What lies on a desk in use: monitors, keyboards, books, cartons, mugs and papers over width x
// depth at z = 0.
Mesh MakeDeskClutter(SceneBuilder& builder, float width, float depth);

}  // namespace msf
