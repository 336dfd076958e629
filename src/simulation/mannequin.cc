#include "simulation/mannequin.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core.hpp>

#include "simulation/painter.h"

namespace msf {
namespace {

// The skeleton in world coordinates.
struct Joints {
  Eigen::Matrix3d hips_w, trunk_w, head_w;  // orientations: columns left (+x), back (+y), up (+z)
  Eigen::Vector3d pelvis_w, neck_w;
  std::array<Eigen::Vector3d, 2> hips, knees, shoulders, elbows, wrists;
};

// Orientation of a limb that leads from `joint` to `end` and whose front looks along `front`.
Eigen::Matrix3d AlongBone(const Eigen::Vector3d& joint, const Eigen::Vector3d& end,
                          const Eigen::Vector3d& front) {
  Eigen::Matrix3d axes;
  axes.col(2) = (joint - end).normalized();
  axes.col(0) = (-front).cross(axes.col(2)).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

// The knee of a leg of given hip and ankle; it bends towards `front`. A leg that is too short is
// stretched straight.
Eigen::Vector3d Knee(const Eigen::Vector3d& hip, const Eigen::Vector3d& ankle,
                     const Eigen::Vector3d& front) {
  const Eigen::Vector3d leg = ankle - hip;
  const double length = std::min(leg.norm(), 0.999 * (body::kThigh + body::kShank));
  const Eigen::Vector3d down = leg.normalized();
  const double along =
      (length * length + body::kThigh * body::kThigh - body::kShank * body::kShank) / (2 * length);
  const double forward = std::sqrt(std::max(0., body::kThigh * body::kThigh - along * along));
  return hip + along * down + forward * (front - front.dot(down) * down).normalized();
}

Eigen::Matrix3d Turn(double angle, const Eigen::Vector3d& axis) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

Joints FindJoints(const BodyPose& pose) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(),
                        z = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d front(pose.heading.x(), pose.heading.y(), 0);
  Joints joints;
  joints.hips_w << z.cross(front), -front, z;
  joints.pelvis_w = {pose.place.x(), pose.place.y(), pose.hip_height_m};
  joints.trunk_w = joints.hips_w * Turn(pose.twist, z) * Turn(pose.lean, x);
  joints.neck_w = joints.pelvis_w + joints.trunk_w * Eigen::Vector3d(0, 0, 0.5);
  joints.head_w = joints.hips_w * Turn(pose.head_turn, z) * Turn(pose.head_nod, x);
  for (int side = 0; side < 2; ++side) {
    const double sign = side == 0 ? 1 : -1;
    joints.hips[side] = joints.pelvis_w + sign * body::kHipOffset * joints.hips_w.col(0);
    joints.knees[side] = Knee(joints.hips[side], pose.ankles_w[side], front);
    const Eigen::Vector3d shoulder(sign * body::kShoulderOffset, 0, body::kShoulderHeight);
    joints.shoulders[side] = joints.pelvis_w + joints.trunk_w * shoulder;
    const Eigen::Matrix3d arm =
        joints.trunk_w * Turn(-pose.arm_forward[side], x) * Turn(-sign * pose.arm_out[side], y);
    const Eigen::Matrix3d forearm = arm * Turn(-pose.elbow_bend[side], x);
    joints.elbows[side] = joints.shoulders[side] - body::kUpperArm * arm.col(2);
    joints.wrists[side] = joints.elbows[side] - body::kForearm * forearm.col(2);
  }
  return joints;
}

Eigen::Isometry3f Pose(const Eigen::Matrix3d& axes, const Eigen::Vector3d& origin) {
  Eigen::Isometry3f pose = Eigen::Isometry3f::Identity();
  pose.linear() = axes.cast<float>();
  pose.translation() = origin.cast<float>();
  return pose;
}

// A limb from its low end to its joint at the origin; `radii` from the low end up, evenly spaced.
void AddLimb(Mesh& mesh, float length, const std::vector<float>& radii, const TextureArea& area) {
  std::vector<Ring> rings = {
      {{0, 0, -length - 0.6f * radii.front()}, 0.3f * radii.front(), 0.3f * radii.front()}};
  for (size_t i = 0; i < radii.size(); ++i) {
    const float z = -length * (1 - static_cast<float>(i) / static_cast<float>(radii.size() - 1));
    rings.push_back({{0, 0, z}, radii[i], radii[i]});
  }
  rings.push_back({{0, 0, 0.7f * radii.back()}, 0.4f * radii.back(), 0.4f * radii.back()});
  mesh.AddLoft(rings, area);
}

}  // namespace

Mannequin::Mannequin(SceneBuilder& builder) {
  Random random = builder.NextRandom();
  const cv::Scalar skins[] = {{150, 180, 224}, {120, 158, 205}, {82, 118, 168}, {55, 80, 120}};
  const cv::Scalar hairs[] = {{28, 32, 40}, {40, 62, 92}, {70, 120, 165}};
  const cv::Scalar trousers[] = {{110, 72, 42}, {52, 52, 56}, {80, 110, 130}, {60, 80, 66}};
  const cv::Scalar skin_color = skins[random.Int(0, 3)], shirt_color = VividColor(random);
  const TextureArea skin = builder.AddTexture(PaintMetal({64, 64}, skin_color, random.Fork(1)));
  const TextureArea face = builder.AddTexture(
      PaintHead({512, 384}, skin_color, hairs[random.Int(0, 2)], random.Fork(2)));
  const TextureArea shirt = builder.AddTexture(PaintShirt({480, 280}, shirt_color, random.Fork(3)));
  const TextureArea sleeve =
      builder.AddTexture(PaintFabric({140, 180}, shirt_color, random.Fork(4)));
  const TextureArea cloth =
      builder.AddTexture(PaintTrousers({220, 240}, trousers[random.Int(0, 3)], random.Fork(5)));
  const TextureArea leather =
      builder.AddTexture(PaintTrousers({180, 80}, {50, 55, 70}, random.Fork(6)));

  AddTrunk(shirt, cloth);
  AddHead(face, skin);
  AddLimb(upper_arm_, static_cast<float>(body::kUpperArm), {0.044f, 0.05f, 0.056f, 0.06f}, sleeve);
  AddLimb(forearm_, static_cast<float>(body::kForearm), {0.028f, 0.036f, 0.042f, 0.04f},
          random.Chance(0.5) ? sleeve : skin);
  const float wrist = -static_cast<float>(body::kForearm);
  forearm_.AddLoft({{{0, 0, wrist - 0.17f}, 0.012f, 0.02f},
                    {{0, 0, wrist - 0.11f}, 0.018f, 0.042f},
                    {{0, 0, wrist - 0.05f}, 0.02f, 0.044f},
                    {{0, 0, wrist + 0.02f}, 0.025f, 0.027f}},
                   skin, 10);
  AddLimb(thigh_, static_cast<float>(body::kThigh), {0.06f, 0.072f, 0.084f, 0.088f}, cloth);
  AddLimb(shank_, static_cast<float>(body::kShank), {0.045f, 0.054f, 0.062f, 0.06f}, cloth);
  const float sole = -static_cast<float>(body::kAnkleHeight);
  shoe_.AddLoft({{{0, -0.06f, sole}, 0, 0},
                 {{0, -0.06f, sole + 0.001f}, 0.045f, 0.135f},
                 {{0, -0.06f, sole + 0.035f}, 0.045f, 0.135f},
                 {{0, -0.04f, sole + 0.065f}, 0.042f, 0.1f},
                 {{0, 0, 0.03f}, 0.042f, 0.05f}},
                leather, 16);
}

void Mannequin::AddTrunk(const TextureArea& shirt, const TextureArea& cloth) {
  trunk_.AddLoft({{{0, 0, -0.06f}, 0.16f, 0.115f},
                  {{0, 0, 0.06f}, 0.155f, 0.112f},
                  {{0, 0, 0.18f}, 0.148f, 0.105f},
                  {{0, -0.005f, 0.32f}, 0.172f, 0.118f},
                  {{0, 0, 0.42f}, 0.19f, 0.112f},
                  {{0, 0.005f, 0.48f}, 0.17f, 0.09f},
                  {{0, 0.005f, 0.52f}, 0.1f, 0.07f},
                  {{0, 0.005f, 0.54f}, 0.062f, 0.06f}},
                 shirt, 22);
  pelvis_.AddLoft({{{0, 0, -0.13f}, 0.09f, 0.09f},
                   {{0, 0, -0.08f}, 0.165f, 0.12f},
                   {{0, 0, 0.05f}, 0.16f, 0.117f}},
                  cloth, 18);
}

void Mannequin::AddHead(const TextureArea& face, const TextureArea& skin) {
  neck_.AddLoft({{{0, 0, -0.02f}, 0.058f, 0.058f}, {{0, 0, 0.1f}, 0.052f, 0.055f}}, skin, 12);
  head_.AddLoft({{{0, -0.02f, 0.04f}, 0.02f, 0.03f},
                 {{0, -0.02f, 0.06f}, 0.05f, 0.065f},
                 {{0, -0.012f, 0.1f}, 0.066f, 0.085f},
                 {{0, 0, 0.16f}, 0.075f, 0.098f},
                 {{0, 0, 0.21f}, 0.077f, 0.1f},
                 {{0, 0.004f, 0.25f}, 0.066f, 0.086f},
                 {{0, 0.006f, 0.28f}, 0.04f, 0.055f},
                 {{0, 0.006f, 0.288f}, 0, 0}},
                face, 24);
  head_.AddLoft({{{0, -0.105f, 0.135f}, 0.016f, 0.016f}, {{0, -0.095f, 0.18f}, 0.006f, 0.008f}},
                skin, 8);  // nose
  for (const float ear : {-0.075f, 0.075f}) {
    head_.AddLoft({{{ear, 0.005f, 0.135f}, 0.008f, 0.012f}, {{ear, 0.005f, 0.185f}, 0.01f, 0.02f}},
                  skin, 8);
  }
}

Mesh Mannequin::Posed(const BodyPose& pose) const {
  const Joints joints = FindJoints(pose);
  const Eigen::Vector3d front = -joints.hips_w.col(1);
  Mesh mesh;
  mesh.Append(pelvis_, Pose(joints.hips_w, joints.pelvis_w));
  mesh.Append(trunk_, Pose(joints.trunk_w, joints.pelvis_w));
  mesh.Append(neck_, Pose(joints.trunk_w, joints.neck_w));
  mesh.Append(head_,
              Pose(joints.head_w, joints.neck_w + joints.trunk_w * Eigen::Vector3d(0, 0, 0.03)));
  for (int side = 0; side < 2; ++side) {
    const Eigen::Vector3d& knee = joints.knees[side];
    const Eigen::Vector3d& ankle = pose.ankles_w[side];
    mesh.Append(thigh_, Pose(AlongBone(joints.hips[side], knee, front), joints.hips[side]));
    mesh.Append(shank_, Pose(AlongBone(knee, ankle, front), knee));
    mesh.Append(shoe_,
                Pose(joints.hips_w * Turn(pose.foot_pitch[side], Eigen::Vector3d::UnitX()), ankle));
    const Eigen::Vector3d& elbow = joints.elbows[side];
    const Eigen::Vector3d chest = -joints.trunk_w.col(1) - 0.3 * joints.trunk_w.col(2);
    mesh.Append(upper_arm_,
                Pose(AlongBone(joints.shoulders[side], elbow, chest), joints.shoulders[side]));
    mesh.Append(forearm_, Pose(AlongBone(elbow, joints.wrists[side],
                                         joints.trunk_w.col(2) - joints.trunk_w.col(1)),
                               elbow));
  }
  return mesh;
}

Eigen::Vector3d Mannequin::BetweenHands(const BodyPose& pose) {
  const Joints joints = FindJoints(pose);
  return 0.5 * (joints.wrists[0] + joints.wrists[1]);
}

}  // namespace msf
