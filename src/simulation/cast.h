// Who and what moves in a scenario.
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "simulation/renderer.h"
#include "simulation/scene_builder.h"
#include "simulation/walk_path.h"
#include "util/status.h"

namespace msf {

struct ActorOptions {
  std::string kind = "walker";
  std::vector<Station> stations;
  bool closed = true;
  double speed_m_s = 1.0;
  double start_s = 0;
  double heading_deg = 0;
  double height_m = 0;
  double size_m = 0.4;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("kind", kind,
          "walker, carrier (a walker with a box in the hands), pusher (one with a chair before the "
          "feet), "
          "sitter, box, ball or chair");
    visit("stations", stations, "the way over the floor; a sitter has one");
    visit("closed", closed, "true: from the last station back to the first, again and again");
    visit("speed_m_s", speed_m_s, "on the way");
    visit("start_s", start_s, "how long the actor has been on the way when the sequence begins");
    visit("heading_deg", heading_deg, "where one who stays in place looks: 0 east, 90 north");
    visit("height_m", height_m, "of the underside of a thing above the floor");
    visit("size_m", size_m, "width of a box, diameter of a ball; chairs have their own");
  }
  Status Check() const;
};

// One or more labelled meshes that move.
class Actor {
 public:
  virtual ~Actor() = default;
  // Appends the meshes as they are at a time.
  virtual void Place(double time_s, std::vector<PlacedMesh>& out) const = 0;
};

class Cast {
 public:
  // `actors` must pass Check(). Their textures go to `builder`; `random` gives manners.
  Cast(const std::vector<ActorOptions>& actors, SceneBuilder& builder, const Random& random);

  // Everything that moves, in world coordinates; labels count from 1.
  std::vector<PlacedMesh> At(double time_s) const;
  // Class of label i at [i - 1]: "person", "box", "ball" or "chair".
  const std::vector<std::string>& classes() const { return classes_; }

 private:
  std::unique_ptr<Actor> MakeActor(const ActorOptions& options, SceneBuilder& builder,
                                   const Random& random);
  int NewLabel(const std::string& class_name);

  std::vector<std::unique_ptr<Actor>> actors_;
  std::vector<std::string> classes_;
};

// What a mask shows of an actor.
struct VisibleActor {
  int label;
  int num_pixels;
  cv::Rect box;  // of the visible pixels
};

// The actors that a mask shows, by label.
std::vector<VisibleActor> FindVisibleActors(const cv::Mat& mask);

}  // namespace msf
