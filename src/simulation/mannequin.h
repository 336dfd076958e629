// A person made of lofted limbs with painted clothes, skin and face.
#pragma once

#include "simulation/body_pose.h"
#include "simulation/mesh.h"
#include "simulation/scene_builder.h"

namespace msf {

class Mannequin {
 public:
  // Every call dresses somebody new.
  explicit Mannequin(SceneBuilder& builder);

  // The body in world coordinates.
  Mesh Posed(const BodyPose& pose) const;
  // Middle between the hands in world coordinates.
  static Eigen::Vector3d BetweenHands(const BodyPose& pose);

 private:
  void AddTrunk(const TextureArea& shirt, const TextureArea& cloth);
  void AddHead(const TextureArea& face, const TextureArea& skin);

  // Limbs hang down from their joint at the origin, front towards -y.
  Mesh trunk_, pelvis_, neck_, head_;
  Mesh upper_arm_, forearm_, thigh_, shank_, shoe_;
};

}  // namespace msf
