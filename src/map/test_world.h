// A ring of landmarks seen from a circle inside it, for the tests of mapping and loop closing: maps
// with known truth and drift, without images.
#pragma once

#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

#include "map/shared_map.h"

namespace msf {

class TestWorld {
 public:
  explicit TestWorld(unsigned seed, int num_landmarks = 5000, double rolling_shutter_s = 0)
      : camera_(CameraWith(rolling_shutter_s)), random_(seed) {
    for (int i = 0; i < num_landmarks; ++i) {
      const double angle_rad = Uniform(-std::numbers::pi, std::numbers::pi);
      const double radius_m = Uniform(4.5, 6.0);
      WorldPoint landmark;
      landmark.p_w = {radius_m * std::sin(angle_rad), Uniform(-1.5, 1.5),
                      radius_m * std::cos(angle_rad)};
      for (uint64_t& bits : landmark.descriptor) bits = random_();
      landmark.max_distance_m = 3.0 * levels_.scale(static_cast<int>(random_() % 3));
      landmarks_.push_back(landmark);
    }
  }

  const std::shared_ptr<const Camera>& camera() const { return camera_; }
  const ScaleLevels& levels() const { return levels_; }
  Map EmptyMap() const {
    Map map(camera_, levels_);
    map.StartNewMap();
    return map;
  }

  // The camera at `angle_rad` on a circle of 3 m, looking outward.
  static Rigid3d PoseOnCircle(double angle_rad) {
    const Eigen::Quaterniond R_wc(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitY()));
    return Rigid3d(R_wc, R_wc * Eigen::Vector3d(0, 0, 3)).Inverse();
  }

  // What the camera sees from there: noisy features, and which landmark each one shows. `velocity`:
  // its motion (see UndoRollingShutter), which a rolling shutter shows.
  struct View {
    std::shared_ptr<const FrameFeatures> features;
    std::shared_ptr<const BagOfWords> words;
    std::vector<int> landmarks;
  };
  View Look(const Rigid3d& T_cw_true, const Vector6d& velocity = Vector6d::Zero()) {
    auto features = std::make_shared<FrameFeatures>();
    View view;
    for (size_t i = 0; i < landmarks_.size(); ++i) {
      const Eigen::Vector3d p_c = SeenByRow(T_cw_true * landmarks_[i].p_w, velocity);
      if (p_c.z() < 0.5) continue;
      const Eigen::Vector2d uv_px =
          camera_->Project(p_c) + Eigen::Vector2d(Normal(0.4), Normal(0.4));
      if (uv_px.x() < 0 || uv_px.y() < 0 || uv_px.x() >= camera_->width ||
          uv_px.y() >= camera_->height)
        continue;
      AddFeature(landmarks_[i], uv_px, p_c, *features);
      view.landmarks.push_back(static_cast<int>(i));
    }
    features->BuildGrid(*camera_);
    view.features = features;
    view.words = Describe(view.landmarks);
    return view;
  }

  // Adds a keyframe without points that is at T_cw_true but believed at T_cw to the active map.
  KeyFrameId AddBareKeyFrame(const Rigid3d& T_cw_true, const Rigid3d& T_cw, Map& map) {
    const KeyFrameId id = Insert(T_cw_true, T_cw, map);
    map.UpdateConnections(id);
    return id;
  }

  // The same with points: it observes those of landmarks that the map has made within the last few
  // keyframes, and makes new ones.
  KeyFrameId AddKeyFrame(const Rigid3d& T_cw_true, const Rigid3d& T_cw, Map& map) {
    const KeyFrameId id = Insert(T_cw_true, T_cw, map);
    const FrameFeatures& features = *map.FindKeyFrame(id)->features;
    const Rigid3d T_wc = T_cw.Inverse();
    for (int i = 0; i < features.size(); ++i) {
      MapPointId& known = point_of_[Landmark(id, i)];
      const MapPoint* point = map.FindPoint(map.Resolve(known));
      if (point && point->map_id == map.active_map() &&
          id.value() - point->first_keyframe.value() <= kMemory) {
        map.AddObservation(point->id, id, i);
        map.UpdateNormalAndRange(point->id);
      } else {
        known = map.AddPoint(T_wc * features.PointInCamera(i, *camera_), id, i);
      }
    }
    map.UpdateConnections(id);
    return id;
  }

  // Walks along the circle from one angle to another; the believed motion from keyframe to keyframe
  // is off by `drift` (twist). The first keyframe is believed at T_cw_start.
  std::vector<KeyFrameId> Walk(double from_rad, double to_rad, double step_rad,
                               const Vector6d& drift, const Rigid3d& T_cw_start, Map& map) {
    std::vector<KeyFrameId> ids;
    Rigid3d T_cw = T_cw_start, T_cw_true = PoseOnCircle(from_rad);
    double angle_rad = from_rad;
    while (angle_rad <= to_rad) {
      const Rigid3d T_cw_next = PoseOnCircle(angle_rad);
      if (!ids.empty()) T_cw = Rigid3d::Exp(drift) * (T_cw_next * T_cw_true.Inverse()) * T_cw;
      T_cw_true = T_cw_next;
      ids.push_back(AddKeyFrame(T_cw_true, T_cw, map));
      angle_rad += step_rad;
    }
    return ids;
  }

  const Rigid3d& Truth(KeyFrameId id) const { return truth_.at(id); }
  // Which landmark a feature of a keyframe shows, and where that is.
  int Landmark(KeyFrameId id, int feature) const { return shown_.at(id)[feature]; }
  const Eigen::Vector3d& Place(int landmark) const { return landmarks_[landmark].p_w; }

  // Root mean square distance of the keyframes' places from the truth, m, after moving the first
  // one onto it.
  double Error(const Map& map, const std::vector<KeyFrameId>& ids) const {
    const Rigid3d T_true_map = Truth(ids.front()).Inverse() * map.PoseOf(ids.front());
    double sum = 0;
    for (const KeyFrameId id : ids) {
      const Eigen::Vector3d centre = map.PoseOf(id).Inverse().translation();
      sum += (T_true_map * centre - Truth(id).Inverse().translation()).squaredNorm();
    }
    return std::sqrt(sum / ids.size());
  }

  // Words as an ideal vocabulary would find them.
  static std::shared_ptr<const BagOfWords> Describe(const std::vector<int>& landmarks) {
    std::map<uint32_t, float> words;
    std::map<uint32_t, std::vector<int>> nodes;
    for (size_t i = 0; i < landmarks.size(); ++i) {
      words[landmarks[i] % 2000] += 1.0f / landmarks.size();
      nodes[landmarks[i] % 100].push_back(static_cast<int>(i));
    }
    BagOfWords bag;
    bag.words.assign(words.begin(), words.end());
    bag.nodes.assign(nodes.begin(), nodes.end());
    return std::make_shared<const BagOfWords>(std::move(bag));
  }

 private:
  static constexpr int kMemory = 4;  // keyframes
  struct WorldPoint {
    Eigen::Vector3d p_w = Eigen::Vector3d::Zero();
    Descriptor descriptor{};
    double max_distance_m = 0;
  };

  static std::shared_ptr<const Camera> CameraWith(double rolling_shutter_s) {
    Camera camera = *Camera::Preset("simulated");
    camera.disparity_noise_px = 0.3;
    camera.rolling_shutter_s = rolling_shutter_s;
    return std::make_shared<const Camera>(camera);
  }
  // Where a point is when the row that shows it is exposed; the row decides the time and the time
  // the row.
  Eigen::Vector3d SeenByRow(const Eigen::Vector3d& p_c, const Vector6d& velocity) const {
    Eigen::Vector3d p_row = p_c;
    for (int i = 0; i < 10 && camera_->rolling_shutter_s > 0 && p_row.z() > 0; ++i) {
      const double row_share = camera_->Project(p_row).y() / (camera_->height - 1) - 0.5;
      p_row = Rigid3d::Exp(velocity * (row_share * camera_->rolling_shutter_s)) * p_c;
    }
    return p_row;
  }
  KeyFrameId Insert(const Rigid3d& T_cw_true, const Rigid3d& T_cw, Map& map) {
    const View view = Look(T_cw_true);
    KeyFrame keyframe;
    keyframe.T_cw = T_cw;
    keyframe.features = view.features;
    keyframe.words = view.words;
    keyframe.colors_bgr.resize(view.landmarks.size());
    const KeyFrameId id = map.AddKeyFrame(keyframe);
    truth_[id] = T_cw_true;
    shown_[id] = view.landmarks;
    return id;
  }
  void AddFeature(const WorldPoint& landmark, const Eigen::Vector2d& uv_px,
                  const Eigen::Vector3d& p_c, FrameFeatures& features) {
    const double disparity_px = camera_->bf / p_c.z() + Normal(0.2);
    features.uv_px.push_back(uv_px.cast<float>());
    features.image_px.push_back(uv_px.cast<float>());
    features.depth_m.push_back(static_cast<float>(camera_->bf / disparity_px));
    features.u_right_px.push_back(static_cast<float>(uv_px.x() - disparity_px));
    features.angle_rad.push_back(0);
    features.level.push_back(
        static_cast<uint8_t>(levels_.Predict(landmark.max_distance_m / p_c.norm())));
    features.static_weight.push_back(1);
    Descriptor descriptor = landmark.descriptor;
    for (int flips = 0; flips < 8; ++flips) {
      const uint64_t bit = random_() % 256;
      descriptor[bit / 64] ^= uint64_t{1} << (bit % 64);
    }
    features.descriptors.push_back(descriptor);
  }
  double Uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  double Normal(double sigma) { return std::normal_distribution<double>(0, sigma)(random_); }

  const std::shared_ptr<const Camera> camera_;
  const ScaleLevels levels_{8, 1.2};
  std::mt19937_64 random_;
  std::vector<WorldPoint> landmarks_;
  std::map<int, MapPointId> point_of_;
  std::map<KeyFrameId, Rigid3d> truth_;
  std::map<KeyFrameId, std::vector<int>> shown_;
};

}  // namespace msf
