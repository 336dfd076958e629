// The depth camera: pinhole with Brown distortion for colour, depth registered to colour, and the
// virtual stereo baseline.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "util/status.h"

namespace msf {

// Intrinsics of one RGB-D camera. Pixels have their centres at whole numbers.
struct Camera {
  int width = 640;
  int height = 480;
  double fx = 0, fy = 0, cx = 0, cy = 0;          // px
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;  // Brown distortion, OpenCV's order
  double bf = 40;              // focal length times virtual stereo baseline, px m
  double depth_factor = 5000;  // depth image value of one metre
  // How far depth can be trusted: the noise of bf / depth, px, which a structured-light or stereo
  // camera has equal at all depths. What its calibration leaves (up to a per cent of depth) counts
  // as noise, too: with a Kinect's mere 0.15 px depth would overrule positions that agree.
  double disparity_noise_px = 1;
  double fps = 30;  // nominal frame rate, Hz
  // Rows of the colour image are exposed one after the other: so long after the first row the last
  // one is, s. 0: all at once (global shutter).
  double rolling_shutter_s = 0;
  // The time stamp of a colour image is so long after the exposure of its middle row, s.
  double stamp_lag_s = 0;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("width", width, "image width, px");
    visit("height", height, "image height, px");
    visit("fx", fx, "focal length, px; must be given");
    visit("fy", fy, "focal length, px; must be given");
    visit("cx", cx, "principal point, px, inside the image; must be given");
    visit("cy", cy, "principal point, px, inside the image; must be given");
    visit("k1", k1, "radial distortion");
    visit("k2", k2, "radial distortion");
    visit("p1", p1, "tangential distortion");
    visit("p2", p2, "tangential distortion");
    visit("k3", k3, "radial distortion");
    visit("bf", bf, "focal length times virtual stereo baseline, px m");
    visit("depth_factor", depth_factor, "depth image value of one metre");
    visit("disparity_noise_px", disparity_noise_px,
          "noise of bf / depth, what the sensor's calibration leaves included, px");
    visit("fps", fps, "nominal frame rate, Hz");
    visit("rolling_shutter_s", rolling_shutter_s,
          "time from the exposure of the first row of the colour image to that of the last, s; 0: "
          "all at once");
    visit(
        "stamp_lag_s", stamp_lag_s,
        "the time stamp of a colour image is so long after the exposure of its middle row, s; the "
        "trajectory tells where the camera was at the time stamps");
  }
  Status Check() const;
  bool operator==(const Camera&) const = default;

  bool HasDistortion() const { return k1 != 0 || k2 != 0 || p1 != 0 || p2 != 0 || k3 != 0; }
  double baseline_m() const { return bf / fx; }

  // Ideal (undistorted) pixel of a camera-frame point with z > 0, and back for a depth z in metres.
  Eigen::Vector2d Project(const Eigen::Vector3d& p_c) const {
    return {fx * p_c.x() / p_c.z() + cx, fy * p_c.y() / p_c.z() + cy};
  }
  Eigen::Vector3d Unproject(const Eigen::Vector2d& uv_px, double z_m) const {
    return {(uv_px.x() - cx) / fx * z_m, (uv_px.y() - cy) / fy * z_m, z_m};
  }
  // Between ideal pixels and the pixels of the distorted image.
  Eigen::Vector2d Distort(const Eigen::Vector2d& ideal_px) const;
  Eigen::Vector2d Undistort(const Eigen::Vector2d& image_px) const;

  // A rectangle of ideal pixels that holds the image, distorted or not.
  Eigen::AlignedBox2d IdealBounds() const;

  // A known camera: "tum_fr1", "tum_fr2", "tum_fr3", "bonn" or "simulated"; an error lists the
  // names.
  static StatusOr<Camera> Preset(const std::string& name);
  static std::vector<std::string> PresetNames();
};

}  // namespace msf
