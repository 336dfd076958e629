#include "simulation/cast.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "simulation/body_pose.h"
#include "simulation/furniture.h"
#include "simulation/mannequin.h"

namespace msf {
namespace {

Eigen::Isometry3f FacingAlong(const Eigen::Vector2d& heading, const Eigen::Vector3d& foot) {
  const float angle =
      static_cast<float>(std::atan2(heading.x(), -heading.y()));  // turns -y to the heading
  Eigen::Isometry3f pose = Eigen::Isometry3f::Identity();
  pose.translate(foot.cast<float>());
  pose.rotate(Eigen::AngleAxisf(angle, Eigen::Vector3f::UnitZ()));
  return pose;
}

class Person : public Actor {
 public:
  Person(const ActorOptions& options, const WalkPath& path, Mannequin body, const Random& random,
         int label)
      : options_(options), path_(path), body_(std::move(body)), manner_(random), label_(label) {}

  void Place(double time_s, std::vector<PlacedMesh>& out) const override {
    out.push_back({body_.Posed(PoseAt(time_s)), label_});
  }

 protected:
  BodyPose PoseAt(double time_s) const {
    if (options_.kind == "sitter")
      return SittingPose(path_.PlaceAt(0), path_.HeadingAt(0), time_s, manner_);
    const bool hands_are_full = options_.kind == "carrier" || options_.kind == "pusher";
    return WalkingPose(path_, time_s + options_.start_s, manner_, hands_are_full);
  }

 private:
  ActorOptions options_;
  WalkPath path_;
  Mannequin body_;
  Manner manner_;
  int label_;
};

// Somebody with a thing: before the hands or, when it is pushed, before the feet.
class Carrier : public Person {
 public:
  Carrier(Person person, Mesh thing, int thing_label, bool pushes)
      : Person(std::move(person)),
        thing_(std::move(thing)),
        thing_label_(thing_label),
        pushes_(pushes) {}

  void Place(double time_s, std::vector<PlacedMesh>& out) const override {
    Person::Place(time_s, out);
    const BodyPose pose = PoseAt(time_s);
    PlacedMesh thing{{}, thing_label_};
    thing.mesh.Append(
        thing_, FacingAlong(pose.heading, pushes_ ? BeforeTheFeet(pose) : BeforeTheHands(pose)));
    out.push_back(std::move(thing));
  }

 private:
  static Eigen::Vector3d BeforeTheHands(const BodyPose& pose) {
    Eigen::Vector3d foot = Mannequin::BetweenHands(pose);
    foot.head<2>() += 0.15 * pose.heading;
    foot.z() -= 0.08;
    return foot;
  }
  static Eigen::Vector3d BeforeTheFeet(const BodyPose& pose) {
    const Eigen::Vector2d place = pose.place + 0.7 * pose.heading;
    return {place.x(), place.y(), 0};
  }

  Mesh thing_;
  int thing_label_;
  bool pushes_;
};

// A box or chair that slides or a ball that rolls, on the floor or through the air.
class Thing : public Actor {
 public:
  Thing(const ActorOptions& options, const WalkPath& path, Mesh mesh, int label)
      : options_(options), path_(path), mesh_(std::move(mesh)), label_(label) {}

  void Place(double time_s, std::vector<PlacedMesh>& out) const override {
    const double distance_m = path_.ProgressAt(time_s + options_.start_s).distance_m;
    const Eigen::Vector2d place = path_.PlaceAt(distance_m);
    Eigen::Isometry3f pose = Eigen::Isometry3f::Identity();
    pose.translate(Eigen::Vector3d(place.x(), place.y(), options_.height_m).cast<float>());
    if (options_.kind == "ball") {
      // Exact for a straight way; where it bends the ball slips a little, but never jumps.
      const Eigen::Vector2d rolled = place - path_.PlaceAt(0);
      const double radius = options_.size_m / 2, distance = std::max(rolled.norm(), 1e-9);
      const Eigen::Vector3d axis(-rolled.y() / distance, rolled.x() / distance, 0);
      const Eigen::Vector3d center(0, 0, radius);
      pose.translate(center.cast<float>());
      pose.rotate(Eigen::AngleAxisd(distance / radius, axis).cast<float>());
      pose.translate(-center.cast<float>());
    } else {
      const double turn = options_.heading_deg * std::numbers::pi / 180;
      pose.rotate(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()).cast<float>());
    }
    PlacedMesh thing{{}, label_};
    thing.mesh.Append(mesh_, pose);
    out.push_back(std::move(thing));
  }

 private:
  ActorOptions options_;
  WalkPath path_;
  Mesh mesh_;
  int label_;
};

}  // namespace

Status ActorOptions::Check() const {
  const std::vector<std::string> kinds = {"walker", "carrier", "pusher", "sitter",
                                          "box",    "ball",    "chair"};
  if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) {
    return Status::Error("actors: kind is '" + kind +
                         "'; known are walker, carrier, pusher, sitter, box, ball, chair");
  }
  if (!(size_m > 0)) return Status::Error("actors: size_m must be positive");
  const Status status = WalkPath::Check(stations, speed_m_s);
  return status.ok() ? status : Status::Error("actors: " + status.message());
}

Cast::Cast(const std::vector<ActorOptions>& actors, SceneBuilder& builder, const Random& random) {
  for (size_t i = 0; i < actors.size(); ++i)
    actors_.push_back(MakeActor(actors[i], builder, random.Fork(i)));
}

int Cast::NewLabel(const std::string& class_name) {
  classes_.push_back(class_name);
  return static_cast<int>(classes_.size());
}

std::unique_ptr<Actor> Cast::MakeActor(const ActorOptions& options, SceneBuilder& builder,
                                       const Random& random) {
  const WalkPath path(options.stations, options.closed, options.speed_m_s, options.heading_deg);
  const float size = static_cast<float>(options.size_m);
  if (options.kind == "ball") {
    return std::make_unique<Thing>(options, path, MakeBall(builder, size / 2), NewLabel("ball"));
  }
  if (options.kind == "box") {
    return std::make_unique<Thing>(
        options, path, MakeCarton(builder, size, 0.8f * size, 0.75f * size), NewLabel("box"));
  }
  if (options.kind == "chair") {
    return std::make_unique<Thing>(options, path, MakeChair(builder), NewLabel("chair"));
  }
  Person person(options, path, Mannequin(builder), random, NewLabel("person"));
  if (options.kind == "pusher")
    return std::make_unique<Carrier>(std::move(person), MakeChair(builder), NewLabel("chair"),
                                     true);
  if (options.kind != "carrier") return std::make_unique<Person>(std::move(person));
  Mesh box = MakeCarton(builder, size, 0.75f * size, 0.7f * size);
  return std::make_unique<Carrier>(std::move(person), std::move(box), NewLabel("box"), false);
}

std::vector<PlacedMesh> Cast::At(double time_s) const {
  std::vector<PlacedMesh> meshes;
  for (const std::unique_ptr<Actor>& actor : actors_) actor->Place(time_s, meshes);
  return meshes;
}

std::vector<VisibleActor> FindVisibleActors(const cv::Mat& mask) {
  std::map<int, VisibleActor> found;
  for (int y = 0; y < mask.rows; ++y) {
    const uint8_t* row = mask.ptr<uint8_t>(y);
    for (int x = 0; x < mask.cols; ++x) {
      if (row[x] == 0) continue;
      VisibleActor& actor = found.try_emplace(row[x], VisibleActor{row[x], 0, {}}).first->second;
      ++actor.num_pixels;
      actor.box |= cv::Rect(x, y, 1, 1);
    }
  }
  std::vector<VisibleActor> actors;
  actors.reserve(found.size());
  for (const auto& [label, actor] : found) actors.push_back(actor);
  return actors;
}

}  // namespace msf
